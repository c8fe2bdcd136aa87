"""Images wait for their labels, and get the same ones as if all were known at once."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.errors import SettingError
from mpap_cli.observations import NS_PER_S, Int8Array, IntArray, PoseBlock, Press
from mpap_cli.params import BumperParams, ObstacleParams
from mpap_cli.properties.driven import driven_ahead
from mpap_cli.properties.obstacle_labels import label_patches, pressed_images
from mpap_cli.properties.patch_queue import PatchQueue, SettledPatches
from mpap_cli.properties.visits import Sightings, Visits, VisitSpool

TENTH_NS = NS_PER_S // 10
SHAPE = (2, 3)


def new_queue(params: ObstacleParams, bumper: BumperParams | None = None) -> PatchQueue:
    """Return an empty queue."""
    return PatchQueue(params, bumper or BumperParams(), SHAPE)


def ids_of(n: int) -> IntArray:
    """Return ids of the patches of n images, all different."""
    return np.arange(n * 6, dtype=np.int64).reshape(n, 6)


def poses_of(stamps_ns: IntArray) -> PoseBlock:
    """Return a robot that drives for three seconds and stands for three."""
    x = np.cumsum((stamps_ns // NS_PER_S) % 6 < 3) * 0.02
    return PoseBlock(stamps_ns, np.stack([x, 0 * x, 0 * x], axis=1))


@given(
    st.lists(st.sampled_from([1, 2, 5, 20]), min_size=1, max_size=60),
    st.lists(st.tuples(st.integers(1, 60), st.integers(1, 20)), max_size=5),
    st.integers(1, 70),
    st.booleans(),
)
def test_batches_do_not_change_labels(
    gaps: list[int], bumps: list[tuple[int, int]], step: int, odometry: bool
) -> None:
    """However the log is cut, labels are those of the whole log, in order."""
    params = ObstacleParams()
    stamps_ns = np.cumsum(np.array(gaps, dtype=np.int64)) * TENTH_NS
    edges = np.cumsum(np.array(bumps, dtype=np.int64)) * TENTH_NS
    presses = [Press(int(start), int(end)) for start, end in edges.reshape(-1, 2)]
    poses = poses_of(np.arange(0, int(stamps_ns[-1]) + 3 * NS_PER_S, TENTH_NS // 2))
    ids, settled, last_ns = ids_of(len(gaps)), list[SettledPatches](), -1
    queue = new_queue(params)

    for until_ns in range(0, int(stamps_ns[-1]) + step * TENTH_NS, step * TENTH_NS):
        inside = (last_ns < stamps_ns) & (stamps_ns <= until_ns)
        queue.add(stamps_ns[inside], ids[inside])
        if odometry:
            at = (last_ns < poses.stamps_ns) & (poses.stamps_ns <= until_ns)
            queue.add_poses(PoseBlock(poses.stamps_ns[at], poses.poses[at]))
        begun = [press for press in presses if press.start_ns <= until_ns]
        needed_ns = queue.needs_presses_from_ns
        recent = [press for press in begun if needed_ns is None or press.end_ns > needed_ns]
        settled.append(queue.settle(recent, until_ns))
        last_ns = until_ns
    settled.append(queue.end(presses))

    seen = poses.stamps_ns <= last_ns
    known = PoseBlock(poses.stamps_ns[seen], poses.poses[seen])
    driven_m = driven_ahead(stamps_ns, known, params.driven_before_s) if odometry else None
    wanted = label_patches(stamps_ns, presses, params, SHAPE, driven_m)
    assert len(queue) == 0
    assert np.concatenate([part.stamps_ns for part in settled]).tolist() == stamps_ns.tolist()
    assert np.concatenate([part.ids for part in settled]).tolist() == ids.tolist()
    assert np.concatenate([part.labels for part in settled]).tolist() == wanted.tolist()
    press_ns = np.concatenate([part.press_ns for part in settled])
    assert press_ns.tolist() == pressed_images(stamps_ns, presses, 0.2).tolist()


@pytest.mark.parametrize(
    ("params", "bumper", "waits_s"),
    [
        (ObstacleParams(), BumperParams(), 5),
        (ObstacleParams(driven_before_s=9.0), BumperParams(), 10),
        (ObstacleParams(bump_image_s=7.0), BumperParams(), 8),
        (ObstacleParams(), BumperParams(bump_merge=30.0), 31),
    ],
)
def test_an_image_waits_until_nothing_can_change_its_labels(
    params: ObstacleParams, bumper: BumperParams, waits_s: int
) -> None:
    """At least five seconds, and a second more than labels look ahead."""
    queue = new_queue(params, bumper)
    queue.add(np.zeros(1, dtype=np.int64), ids_of(1))

    early = queue.settle([], waits_s * NS_PER_S - 1)
    late = queue.settle([], waits_s * NS_PER_S)

    assert (early.stamps_ns.size, late.stamps_ns.size) == (0, 1)


@pytest.mark.parametrize("labelled", [True, False])
def test_memory_does_not_grow_with_the_log(labelled: bool) -> None:
    """Ten minutes leave some seconds of images and odometry behind, or none."""
    queue = new_queue(ObstacleParams())

    for second in range(600):
        start_ns = second * NS_PER_S
        stamps_ns = start_ns + np.arange(10, dtype=np.int64) * TENTH_NS
        queue.add(stamps_ns, ids_of(10))
        queue.add_poses(poses_of(stamps_ns))
        if labelled:
            queue.settle([], start_ns + NS_PER_S - 1)
        else:
            queue.end([])

    assert len(queue) == (50 if labelled else 0)
    n_poses = 0 if queue._poses is None else queue._poses.stamps_ns.size
    assert n_poses == (60 if labelled else 0)


def test_rows_that_are_to_be_labelled_must_exist() -> None:
    """A setting that could have no effect is refused."""
    with pytest.raises(SettingError, match=r"setting label-rows: found 1:3, expected rows of"):
        new_queue(ObstacleParams(label_rows="1:3"))


def visits_of(sightings: Sightings, labels: Int8Array) -> Visits:
    """Count visits of the ids 0 to 3, two of which are one cluster."""
    spool = VisitSpool()
    spool.add(sightings, labels, 0)
    return spool.count(lambda ids: np.array([0, 1, 1, 2])[ids], 3)


@given(st.data())
def test_sightings_keep_every_visit(data: st.DataObject) -> None:
    """Fewer observations, the same visits and presses."""
    n = data.draw(st.integers(0, 40))
    gaps = data.draw(st.lists(st.sampled_from([0, 1, 4, 9, 19, 20, 21]), min_size=n, max_size=n))
    random = np.random.default_rng(data.draw(st.integers(0, 999)))
    stamps_ns = np.cumsum(np.array(gaps, dtype=np.int64)) * TENTH_NS
    ids = random.integers(0, 4, (n, 3))
    labels = random.integers(-1, 2, (n, 3)).astype(np.int8)
    press_ns = stamps_ns // (3 * NS_PER_S)
    every = Sightings(np.repeat(stamps_ns, 3), ids.ravel(), np.repeat(press_ns, 3))

    sightings, kept = SettledPatches(stamps_ns, ids, labels, press_ns).sightings()

    found, wanted = visits_of(sightings, kept), visits_of(every, labels.ravel())
    assert sightings.ids.size <= every.ids.size
    assert (np.diff(sightings.stamps_ns) >= 0).all()
    for name in ("visits", "positive", "negative", "presses"):
        assert getattr(found, name).tolist() == getattr(wanted, name).tolist()
