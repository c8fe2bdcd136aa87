"""Labels settle, are counted and become probabilities."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import beta

from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.observations import NS_PER_S, Bump
from mpap_cli.params import BumperParams, MetaPointParams, PropertyParams
from mpap_cli.properties.counts import LabelQueue, SettledLabels, count_labels, jeffreys, ratio
from mpap_cli.properties.labels import label_scans, press_starts
from mpap_cli.properties.presses import PressTracker

TENTH_NS = NS_PER_S // 10
EVENTS = st.lists(st.tuples(st.integers(0, 60), st.booleans()), max_size=25)


@given(
    EVENTS,
    st.lists(st.integers(0, 8), min_size=1, max_size=120),
    st.lists(st.integers(0, 30), min_size=1, max_size=40),
    st.sampled_from(["level", "edge", "pulse"]),
    st.sampled_from([(0.0, None, 1.0), (2.5, None, 1.0), (0.4, 1.5, 9.0), (12.0, 3.0, 0.3)]),
)
def test_settled_labels_equal_labels_made_at_the_end(
    events: list[tuple[int, bool]],
    scan_steps: list[int],
    batch_steps: list[int],
    kind: str,
    times: tuple[float, float | None, float],
) -> None:
    """However the log is cut into batches, and wherever presses begin and end."""
    bumper = BumperParams(bump_merge=times[0], bump_max_press=times[1])
    params = PropertyParams(early_s=times[2])
    stamps_ns = np.cumsum(np.array(scan_steps, dtype=np.int64)) * TENTH_NS
    at = np.cumsum([step for step, _ in events]) * TENTH_NS
    bumps = [Bump(int(t), "", on) for t, (_, on) in zip(at, events, strict=True)]
    end_ns = int(max([stamps_ns[-1], *at]))
    tracker, queue = PressTracker(kind, bumper), LabelQueue(params, bumper)
    settled: list[SettledLabels] = []

    last_ns = -1
    for until_ns in np.cumsum(batch_steps) * 5 * TENTH_NS:
        inside = (stamps_ns > last_ns) & (stamps_ns <= until_ns)
        queue.add(stamps_ns[inside], np.flatnonzero(inside))
        tracker.add([bump for bump in bumps if last_ns < bump.stamp_ns <= until_ns])
        tracker.settle(int(until_ns))
        settled.append(queue.settle(tracker.recent(queue.needs_presses_from_ns), int(until_ns)))
        last_ns = int(until_ns)
    rest = stamps_ns > last_ns
    queue.add(stamps_ns[rest], np.flatnonzero(rest))
    tracker.add([bump for bump in bumps if bump.stamp_ns > last_ns])
    tracker.end(max(end_ns, last_ns))
    settled.append(queue.end(tracker.recent(queue.needs_presses_from_ns)))

    ids = np.concatenate([part.ids for part in settled])
    labels = np.concatenate([part.labels for part in settled])
    press_ns = np.concatenate([part.press_ns for part in settled])
    assert ids.tolist() == list(range(stamps_ns.size))
    assert labels.tolist() == label_scans(stamps_ns, tracker.presses, params).tolist()
    pressed = labels[:, 0] == 1
    assert press_ns[pressed].tolist() == press_starts(stamps_ns, tracker.presses)[pressed].tolist()
    assert len(queue) == 0


def test_what_waits_is_bounded_by_the_wait() -> None:
    """Five seconds of scans wait, however long the log."""
    queue = LabelQueue(PropertyParams(), BumperParams())
    waiting = []

    for second in range(100):
        queue.add(second * NS_PER_S + np.arange(10) * TENTH_NS, np.arange(10))
        queue.settle((), (second + 1) * NS_PER_S - 1)
        waiting.append(len(queue))

    assert max(waiting) == 50


def test_labels_are_counted_on_their_meta_points() -> None:
    """One pair per target; what has no label is not counted, nor what was dropped."""
    points = MetaPoints(MetaPointParams(theta=0.1), 2)
    features = np.array([[1.0, 0.0], [0.0, 1.0]], dtype=np.float32)
    ids, _ = points.add_data_points(features, np.arange(2))
    labels = np.array([[1, -1, 0], [0, 0, -1], [1, 1, -1], [1, 1, 1]], dtype=np.int8)

    count_labels(points, np.array([ids[0], ids[0], ids[1], 99]), labels)

    assert points.counts.tolist() == [[[1, 1], [1, 0], [1, 0]], [[0, 1], [0, 1], [0, 0]]]


@pytest.mark.parametrize(("positive", "negative"), [(0, 1), (1, 9), (500, 2), (3, 0)])
def test_jeffreys_is_the_posterior_of_a_share(positive: int, negative: int) -> None:
    """Mean and equal-tailed interval of Beta(positive + 1/2, negative + 1/2)."""
    posterior = beta(positive + 0.5, negative + 0.5)

    mean, low, high = jeffreys(np.array([positive]), np.array([negative]), level=0.9)

    wanted = (posterior.mean(), posterior.ppf(0.05), posterior.ppf(0.95))
    assert (mean[0], low[0], high[0]) == pytest.approx(wanted)


def test_nothing_counted_gives_no_probability() -> None:
    """Neither the share nor the posterior pretends to know."""
    nothing = np.zeros(1, dtype=np.int64)

    shares = [ratio(np.zeros((1, 2), dtype=np.int64)), *jeffreys(nothing, nothing)]

    assert np.isnan(shares).all()
