"""Labels of a log on its way: what waits for them, and which presses are looked at."""

from collections.abc import Sequence

import numpy as np
import pytest

from mpap_cli.observations import NS_PER_S, Bump, Int8Array, IntArray, PoseBlock, Press
from mpap_cli.params import BumperParams, ObstacleParams, PropertyParams
from mpap_cli.properties.counts import LabelQueue, SettledLabels
from mpap_cli.properties.labels import label_scans
from mpap_cli.properties.patch_queue import PatchQueue
from mpap_cli.systems.labelling import LogLabeller, LogStart

START_NS = 1_577_836_800 * NS_PER_S


def _replay(
    labeller: LogLabeller[SettledLabels], queue: LabelQueue, bumps: Sequence[Bump], n: int
) -> tuple[int, int]:
    """Let n seconds pass with five scans each; return the most that waited, and the presses."""
    most = 0
    for second in range(0, n, 20):
        until_ns = START_NS + (second + 20) * NS_PER_S
        stamps_ns = np.arange(until_ns - 20 * NS_PER_S, until_ns, NS_PER_S // 5)
        queue.add(stamps_ns, np.zeros(stamps_ns.size, np.int64))
        now = tuple(one for one in bumps if 0 <= until_ns - 1 - one.stamp_ns < 20 * NS_PER_S)
        labeller.settle(now, until_ns - 1)
        most = max(most, len(queue))
    return most, len(labeller.presses or ())


@pytest.mark.parametrize(
    ("bumps", "n_presses"),
    [((), 0), ((Bump(START_NS, "", False), Bump(START_NS + 10, "", True)), 1)],
    ids=["no press ever comes", "a press is held for hours"],
)
def test_scans_wait_for_seconds_only(bumps: Sequence[Bump], n_presses: int) -> None:
    """What waits for its label is what was seen in the last six seconds."""
    queue = LabelQueue(PropertyParams(), BumperParams())
    start = LogStart(name="", start_ns=START_NS, bump_kind="level")
    labeller = LogLabeller(start, BumperParams(), queue)

    most, found = _replay(labeller, queue, bumps, 4 * 3600)

    assert found == n_presses
    assert most <= 6 * 5


@pytest.mark.parametrize("pressed", [False, True])
def test_images_and_poses_wait_for_seconds_only(pressed: bool) -> None:
    """What waits for its label, odometry included, is what was seen in the last seconds."""
    queue = PatchQueue(ObstacleParams(), BumperParams(), (6, 6))
    start = LogStart(name="", start_ns=START_NS, bump_kind="level")
    labeller = LogLabeller(start, BumperParams(), queue)
    bumps: Sequence[Bump] = (Bump(START_NS, "", False), Bump(START_NS + 1, "", pressed))
    most = most_poses = 0

    for second in range(0, 3600, 20):
        until_ns = START_NS + (second + 20) * NS_PER_S
        stamps_ns = np.arange(until_ns - 20 * NS_PER_S, until_ns, NS_PER_S)
        queue.add(stamps_ns, np.zeros((20, 36), np.int64))
        queue.add_poses(PoseBlock(stamps_ns, np.zeros((20, 3))))
        labeller.settle(bumps, until_ns - 1)
        bumps, most = (), max(most, len(queue))
        assert queue._poses is not None
        most_poses = max(most_poses, queue._poses.stamps_ns.size)

    assert most <= 6
    assert most_poses <= 8


class _Waiting(LabelQueue):
    """Notes how many presses it is told of at once."""

    most_presses = 0

    def settle(self, presses: Sequence[Press], until_ns: int) -> SettledLabels:
        self.most_presses = max(self.most_presses, len(presses))
        return super().settle(presses, until_ns)


def _labels_of(
    presses: tuple[Press, ...], stamps_ns: IntArray, queue: LabelQueue
) -> tuple[IntArray, Int8Array]:
    """Label scans that come 20 at a time, with presses that are known from the start."""
    labeller = LogLabeller(LogStart(name="", start_ns=0, presses=presses), BumperParams(), queue)
    settled = []
    for part in np.split(stamps_ns, range(20, len(stamps_ns), 20)):
        queue.add(part, np.arange(part.size))
        settled.append(labeller.settle((), int(part[-1])))
    settled.append(labeller.end(int(stamps_ns[-1])))
    return tuple(  # type: ignore[return-value]  # two arrays
        np.concatenate([getattr(one, name) for one in settled]) for name in ("stamps_ns", "labels")
    )


@pytest.mark.parametrize("held", [False, True])
def test_presses_of_ten_thousand_are_looked_at_where_they_matter(held: bool) -> None:
    """Labels are those of all presses at once, though few are looked at in each batch."""
    starts_ns = np.arange(10_000, dtype=np.int64) * 7 * NS_PER_S
    presses = tuple(
        Press(start, start + 900_000_000, held_from_start=held and start == 0)
        for start in starts_ns.tolist()
    )
    stamps_ns = np.arange(0, 3000 * NS_PER_S, NS_PER_S // 3)
    queue = _Waiting(PropertyParams(), BumperParams())

    found_ns, labels = _labels_of(presses, stamps_ns, queue)

    assert np.array_equal(found_ns, stamps_ns)
    assert np.array_equal(labels, label_scans(stamps_ns, presses, PropertyParams()))
    assert queue.most_presses < 10
