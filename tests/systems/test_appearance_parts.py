"""Appearance models become arrays and a header, and come back the same or not at all."""

from collections.abc import Callable

import numpy as np
import pytest

from mpap_cli.errors import ModelError
from mpap_cli.observations import Float32Array
from mpap_cli.params import make_settings
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.model_parts import ModelState
from tests.systems.conftest import CameraDrive
from tests.systems.states import changed, reloaded, same, with_header, without

SETTINGS = make_settings(values={"image-size": "96x72", "reservoir": "80", "eps": "0.25"})

Drive = Callable[[int, int], CameraDrive]
Seen = Callable[..., AppearanceModel]


def test_a_model_comes_back_the_same(camera_drive: Drive, seen: Seen) -> None:
    """Predictions, clusters with their visits, and the state itself, reservoir included."""
    model = seen(SETTINGS)

    again = AppearanceModel.from_state(reloaded(model.state()))

    block = model.embed(camera_drive(24, 9).frames)
    assert model.two_scale.n_reservoir > 0
    assert same(again.state(), model.state())
    assert again.rows() == model.rows()
    one, other = model.predict(block), again.predict(block)
    for name in ("cluster", "distance", "unknown", "p_obstacle"):
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes()


def test_a_model_that_comes_back_does_not_cluster_again(
    monkeypatch: pytest.MonkeyPatch, seen: Seen
) -> None:
    """Its coarse clusters are in the file: with thousands of exemplars they take a while."""
    state = seen(SETTINGS).state()
    again = AppearanceModel.from_state(reloaded(state))
    monkeypatch.setattr(again.two_scale, "coarse", lambda: pytest.fail("clustered again"))

    rows = again.rows()

    assert len(rows) > 0


def test_an_empty_model_comes_back() -> None:
    """It knows its settings only."""
    model = AppearanceModel(make_settings("paper", {"grid": "4x4"}))

    again = AppearanceModel.from_state(reloaded(model.state()))

    assert again.settings == model.settings
    assert (again.n_patches, again.rows(), again.logs) == (16, [], ())


def test_learning_on_is_learning_straight_through(seen: Seen) -> None:
    """Exemplars, labels and visits; the older log is remembered."""
    straight = seen(SETTINGS, seed=2, model=seen(SETTINGS))
    first = AppearanceModel.from_state(reloaded(seen(SETTINGS).state()))

    second = seen(SETTINGS, seed=2, model=first)

    assert [log.name for log in second.logs] == ["1.bag", "2.bag"]
    assert second.n_images == 960
    assert second.two_scale.labels.tolist() == straight.two_scale.labels.tolist()
    assert second.two_scale.exemplars.tobytes() == straight.two_scale.exemplars.tobytes()
    presses = [row.presses for row in second.rows()]
    assert presses == [row.presses for row in straight.rows()]
    assert max(presses) == 16


def test_finish_keeps_the_rows(seen: Seen) -> None:
    """The file of visits goes, their sums stay."""
    model = seen(SETTINGS)
    before = model.rows()

    model.finish()

    assert model.rows() == before


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (with_header(kind="zip"), r"found 'zip' version 1, expected 'mpap appearance model'"),
        (with_header(version=99), r"version 99, expected .* version 1; learn it again"),
        (with_header(settings={"eps": "-1"}), r"header does not fit .* eps"),
        (with_header(settings=[1]), r"header does not fit"),
        (with_header(logs=[{"name": "a"}]), r"header does not fit .*'n_presses'"),
        (with_header(n_iter="many"), r"header does not fit"),
        (with_header(logs=[]), r"exemplar_log does not fit its exemplars"),
        (with_header(settings={"image-size": "96x72", "grid": "1x1"}), r"exemplar_patch does not"),
        (without("coarse.labels"), r"no array coarse.labels"),
        (without("strap.clusters.ids"), r"clusters.ids is missing"),
        (changed("coarse.labels", lambda a: a.astype(np.float32)), r"labels is float32"),
        (changed("coarse.labels", lambda a: a + 1000), r"coarse.labels does not fit"),
        (changed("coarse.labels", lambda a: a * 0), r"coarse.labels does not fit"),
        (changed("coarse.labels", lambda a: a[1:]), r"coarse.labels does not fit"),
        (changed("coarse.exemplars", lambda a: a[::-1].copy()), r"exemplars does not fit"),
        (changed("coarse.exemplars", lambda a: a - 1000), r"exemplars does not fit"),
        (changed("coarse.figures", lambda a: a[:2]), r"figures is float64 \(2,\), expected"),
        (changed("visits.ids", lambda a: a + 10**6), r"visits.ids does not fit"),
        (changed("visits.counts", lambda a: a[1:].copy()), r"visits.ids does not fit"),
        (changed("visits.counts", lambda a: a - 10**6), r"visits.counts does not fit"),
        (changed("strap.reservoir.exemplar_log", lambda a: a + 1), r"exemplar_log does not fit"),
        (changed("strap.clusters.exemplar_patch", lambda a: a + 36), r"exemplar_patch does not"),
        (changed("strap.clusters.labels", lambda a: a - 10**6), r"clusters.labels holds values"),
    ],
)
def test_a_damaged_model_is_refused(
    damage: Callable[[ModelState], ModelState], message: str, state: ModelState
) -> None:
    """Files from elsewhere are not trusted; each part is checked against the others."""
    with pytest.raises(ModelError, match=message):
        AppearanceModel.from_state(damage(reloaded(state)))


def test_exemplars_of_another_width_are_refused(state: ModelState) -> None:
    """They could not be compared with patches."""
    narrow = {
        name: _cut(array) if name.endswith(".exemplars") and array.ndim > 1 else array
        for name, array in state.arrays.items()
    }

    with pytest.raises(ModelError, match=r"of 100 dimensions, its settings make 1\d\d; learn"):
        AppearanceModel.from_state(ModelState(state.header, narrow))


def _cut(exemplars: Float32Array) -> Float32Array:
    """Return exemplars with fewer coordinates, of length 1 again."""
    kept = exemplars[:, :100]
    cut: Float32Array = kept / np.linalg.norm(kept, axis=1, keepdims=True)
    return cut


@pytest.fixture(scope="module")
def state() -> ModelState:
    """Return the state of a model that learnt a minute and a half."""
    from tests.systems.conftest import _seen  # noqa: PLC0415  # the fixture is per test

    return _seen(SETTINGS).state()
