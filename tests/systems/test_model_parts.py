"""Models become arrays and a header, and come back the same or not at all."""

from collections.abc import Callable

import numpy as np
import pytest

from mpap_cli.distance import embed
from mpap_cli.errors import ModelError
from mpap_cli.observations import NS_PER_S, FeatureBlock, Press
from mpap_cli.params import Settings, make_settings
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.labelling import LogStart
from mpap_cli.systems.model_parts import ModelState
from tests.systems.states import changed, reloaded, same, with_header, without


def block_of(settings: Settings, n: int, seed: int) -> FeatureBlock:
    """Return observations of some places, one every half second."""
    n_bins = CollisionModel(settings).meta_points.n_dims - 1
    random = np.random.default_rng(seed)
    places = np.random.default_rng(0).uniform(0.1, 5, size=(60, n_bins))
    rows = places[random.integers(60, size=n)] * random.uniform(0.95, 1.05, size=(n, n_bins))
    stamps_ns = np.arange(n, dtype=np.int64) * NS_PER_S // 2
    ahead = np.ones(n, dtype=np.float32)
    features = embed(rows.astype(np.float32)).astype(np.float32)
    return FeatureBlock(stamps_ns, features, np.arange(n), ahead)


def learn(model: CollisionModel, name: str, seed: int) -> CollisionModel:
    """Let a model learn a log with a press every twenty seconds."""
    block = block_of(model.settings, 200, seed)
    presses = tuple(Press(at * NS_PER_S, (at + 2) * NS_PER_S) for at in range(5, 100, 20))
    model.begin_log(LogStart(name=name, start_ns=0, presses=presses, bump_source="file"))
    model.learn(block)
    model.settle((), int(block.stamps_ns[-1]))
    model.end_log(int(block.stamps_ns[-1]))
    return model


@pytest.mark.parametrize("profile", ["robust", "paper"])
def test_a_model_comes_back_the_same(profile: str) -> None:
    """Predictions, clusters with their visits, and the state itself."""
    model = learn(CollisionModel(make_settings(profile, {"theta": "0.05"})), "a", seed=1)

    again = CollisionModel.from_state(reloaded(model.state()))

    asked = block_of(model.settings, 50, seed=9)
    assert same(again.state(), model.state())
    assert again.clusters() == model.clusters()
    for target in ("contact", "onset", "early"):
        one, other = model.predict(asked, target), again.predict(asked, target)
        assert one.p_collision.tobytes() == other.p_collision.tobytes()


def test_an_empty_model_comes_back() -> None:
    """It knows its settings only."""
    model = CollisionModel(make_settings("paper"))

    again = CollisionModel.from_state(reloaded(model.state()))

    assert again.settings == model.settings
    assert again.clusters() == []


def test_learning_on_counts_the_visits_of_both_times() -> None:
    """What was carried over and what is new add up."""
    settings = make_settings(values={"theta": "0.05"})
    straight = learn(learn(CollisionModel(settings), "a", seed=1), "b", seed=2)
    first = learn(CollisionModel(settings), "a", seed=1)

    second = learn(CollisionModel.from_state(reloaded(first.state())), "b", seed=2)

    assert [log.name for log in second.logs] == ["a", "b"]
    assert second.meta_points.counts.tolist() == straight.meta_points.counts.tolist()
    total = sum(row.visits for row in first.clusters())
    assert sum(row.visits for row in second.clusters()) > total
    assert [row.observations for row in second.clusters()] == [
        row.observations for row in straight.clusters()
    ]


def test_finish_keeps_the_rows() -> None:
    """The file of visits goes, their sums stay."""
    model = learn(CollisionModel(make_settings(values={"theta": "0.05"})), "a", seed=1)
    before = model.clusters()

    model.finish()

    assert model.clusters() == before


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (with_header(kind="zip"), r"found 'zip' version 2, expected 'mpap collision model'"),
        (with_header(version=1), r"version 1, expected .* version 2; learn it again"),
        (with_header(version=99), r"version 99, expected .* version 2; learn it again"),
        (with_header(settings={"theta": "-1"}), r"header does not fit .* theta"),
        (with_header(settings=None, profile="bold"), r"header does not fit"),
        (with_header(settings=[1]), r"header does not fit"),
        (with_header(logs=[{"name": "a"}]), r"header does not fit .*'n_presses'"),
        (with_header(logs=3), r"header does not fit"),
        (with_header(n_iter="many"), r"header does not fit"),
        (without("clustering.labels"), r"no array clustering.labels"),
        (changed("clustering.labels", lambda a: a.astype(np.float32)), r"labels is float32"),
        (changed("clustering.labels", lambda a: a + 1000), r"clustering.labels does not fit"),
        (changed("clustering.labels", lambda a: a[1:]), r"clustering.labels does not fit"),
        (changed("clustering.labels", lambda a: a * 0), r"clustering.labels does not fit"),
        (changed("visits.counts", lambda a: a + 2**60), r"visits.counts does not fit"),
        (changed("meta_points.sums", lambda a: a + 1e300), r"sums holds values .* too large"),
        (changed("meta_points.point_count", lambda a: a + 2**60), r"beyond all counting"),
        (changed("clustering.exemplars", lambda a: a[::-1].copy()), r"exemplars does not fit"),
        (changed("clustering.exemplars", lambda a: a - 1000), r"exemplars does not fit"),
        (changed("clustering.ids", lambda a: a[::-1].copy()), r"clustering.ids does not fit"),
        (changed("clustering.ids", lambda a: a + 10**6), r"clustering.ids does not fit"),
        (changed("clustering.figures", lambda a: -np.abs(a)), r"clustering.figures does not fit"),
        (changed("clustering.figures", lambda a: a * np.nan), r"clustering.figures does not fit"),
        (changed("clustering.figures", lambda a: a[:2]), r"figures is float64 \(2,\), expected"),
        (changed("alarm_odds", lambda a: a - 10), r"alarm_odds does not fit"),
        (changed("alarm_odds", lambda a: a[:1]), r"alarm_odds is float64 \(1,\), expected"),
        (without("alarm_odds"), r"no array alarm_odds"),
        (changed("visits.ids", lambda a: a + 10**6), r"visits.ids does not fit"),
        (changed("visits.counts", lambda a: a[:, :2].copy()), r"visits.counts is int64"),
        (changed("visits.counts", lambda a: a[1:].copy()), r"visits.ids does not fit"),
        (changed("visits.counts", lambda a: a - 10**6), r"visits.counts does not fit"),
        (with_header(logs=[]), r"logs does not fit"),
        (with_header(settings={"bins": "30"}), r"of 24 dimensions, its settings make 42; learn"),
        (without("meta_points.ids"), r"ids"),
    ],
)
def test_a_damaged_model_is_refused(
    damage: Callable[[ModelState], ModelState], message: str
) -> None:
    """Files from elsewhere are not trusted; each part is checked against the others."""
    state = learn(CollisionModel(make_settings(values={"theta": "0.05"})), "a", seed=1).state()

    with pytest.raises(ModelError, match=message):
        CollisionModel.from_state(damage(reloaded(state)))
