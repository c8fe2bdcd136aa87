"""Batches out of scans, bumps, images and poses."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs.bumps.bumpers import BumpPiece
from mpap_cli.logs.files.runs import END_NS
from mpap_cli.logs.image_runs import FramePiece
from mpap_cli.logs.odometry import PosePiece
from mpap_cli.logs.scan_runs import ScanPiece
from mpap_cli.logs.windows import Arrivals, Events, Window
from mpap_cli.observations import NS_PER_S, Batch, Bump, Frame, ScanGeometry

moments = st.lists(st.integers(0, 60 * NS_PER_S) | st.integers(0, 9).map(NS_PER_S.__mul__))


def scans(*stamps_ns: int) -> list[ScanPiece]:
    """Return scans of three beams, each a piece of its own and of one of two geometries."""
    pieces = []
    for stamp_ns in stamps_ns:
        geometry = ScanGeometry(3, 0.0, 0.1 + 0.1 * (stamp_ns % 2), 0.1, 5.0)
        ranges = np.full((1, 3), stamp_ns, dtype=np.float32)
        pieces.append(ScanPiece(np.array([stamp_ns]), np.array([stamp_ns]), ranges, geometry))
    return pieces


def bumps(stamps_ns: list[int], codes: list[int]) -> list[BumpPiece]:
    """Return bumps of one topic."""
    stamps = np.array(stamps_ns, dtype=np.int64)
    return [BumpPiece(stamps, stamps, np.array(codes, dtype=np.int64))]


def images(stamps_ns: list[int]) -> list[FramePiece]:
    """Return images of one topic."""
    stamps = np.array(stamps_ns, dtype=np.int64)
    frames = tuple(Frame(stamp_ns, "compressed", 0, 0, 0, b"") for stamp_ns in stamps_ns)
    return [FramePiece(stamps, stamps, frames)]


def poses(stamps_ns: list[int]) -> list[PosePiece]:
    """Return poses of one topic, which tell their moment."""
    stamps = np.array(stamps_ns, dtype=np.int64)
    return [PosePiece(stamps, stamps, np.repeat(stamps[:, np.newaxis], 3, axis=1).astype(float))]


def stamps_of(batch: Batch) -> tuple[list[int], list[int]]:
    """Return the stamps of scans and of bumps."""
    of_scans = [int(stamp_ns) for block in batch.scans for stamp_ns in block.stamps_ns]
    return of_scans, [bump.stamp_ns for bump in batch.bumps]


def all_stamps(batch: Batch) -> list[list[int]]:
    """Return the stamps of scans, bumps, images and poses."""
    assert batch.poses is not None
    assert batch.poses.poses[:, 1].tolist() == batch.poses.stamps_ns.tolist()
    assert batch.poses.poses.shape == (len(batch.poses.stamps_ns), 3)
    frames = [frame.stamp_ns for frame in batch.frames]
    return [*stamps_of(batch), frames, batch.poses.stamps_ns.tolist()]


@given(came=st.tuples(*[moments] * 4), size=st.integers(1, 6), cuts=st.lists(st.integers(0, 60)))
def test_nothing_is_lost_and_batches_follow_one_another(
    came: tuple[list[int], ...], size: int, cuts: list[int]
) -> None:
    """Each event is in one batch, in order; the batches do not depend on how the events came."""
    window = Window(size, {"": 0}, changes_only=False, with_poses=True)
    at_once = Window(size, {"": 0}, changes_only=False, with_poses=True)
    batches: list[Batch] = []
    begin_ns = -1
    for end_ns in [*sorted(cut * NS_PER_S for cut in cuts), END_NS]:
        parts = [[t for t in stamps_ns if begin_ns <= t < end_ns] for stamps_ns in came]
        window.add(*events_at(*parts))
        batches.extend(window.batches(end_ns))
        begin_ns = end_ns
    at_once.add(*events_at(*came))

    stamps_ns = [all_stamps(batch) for batch in batches]

    assert stamps_ns == [all_stamps(batch) for batch in at_once.batches(END_NS)]
    for kind, moments_ns in enumerate(came):
        assert [t for stamps in stamps_ns for t in stamps[kind]] == sorted(moments_ns)
    for batch, kinds in zip(batches, stamps_ns, strict=True):
        together = [t for stamps in kinds for t in stamps]
        assert batch.until_ns == max(together)
        assert batch.until_ns - min(together) <= 120 * NS_PER_S
        assert len([t for t in kinds[0] if t < kinds[0][-1]]) < size
    for batch, kinds in zip(batches, stamps_ns[1:], strict=False):
        assert all(t > batch.until_ns for stamps in kinds for t in stamps)
    assert all(one.until_ns < other.until_ns for one, other in pairwise(batches))


def events_at(scanned: list[int], touched: list[int], seen: list[int], driven: list[int]) -> Events:
    """Return scans, bumps, images and poses at moments."""
    return Events(scans(*scanned), bumps(touched, [1] * len(touched)), images(seen), poses(driven))


def test_images_make_a_batch_due(monkeypatch: pytest.MonkeyPatch) -> None:
    """The one with which there are enough is in it, with all of the same stamp."""
    monkeypatch.setattr("mpap_cli.logs.waiting.MAX_FRAMES", 3)
    window = Window(100, {}, changes_only=True)
    window.add(scans(0, 2, 4, 5, 9), [], images([1, 3, 5, 5, 6]))

    batches = list(window.batches(END_NS))

    seen = [[frame.stamp_ns for frame in batch.frames] for batch in batches]
    assert seen == [[1, 3, 5, 5], [6]]
    assert [stamps_of(batch)[0] for batch in batches] == [[0, 2, 4, 5], [9]]
    assert [batch.poses for batch in batches] == [None, None]


def test_blocks_have_one_geometry() -> None:
    """Scans that come out of order are sorted; equal geometries share a block."""
    window = Window(9, {}, changes_only=True)
    window.add(scans(2, 4, 0), [])
    window.add(scans(7, 5, 8), [])

    (batch,) = window.batches(END_NS)

    assert [block.stamps_ns.tolist() for block in batch.scans] == [[0, 2, 4], [5, 7], [8]]
    assert [block.ranges[:, 0].tolist() for block in batch.scans] == [[0, 2, 4], [5, 7], [8]]
    assert all(block.ranges.shape == (len(block.stamps_ns), 3) for block in batch.scans)
    assert all(block.stamps_ns.dtype == np.int64 for block in batch.scans)


def test_each_sensor_has_a_state_of_its_own() -> None:
    """What repeats the state of its sensor is left out, also over batches and topics."""
    window = Window(9, {"/a": 0, "/b": 1}, changes_only=True)
    window.add([], [*bumps([0, 2, 4], [1, 1, 0]), *bumps([1, 3, 5], [2, 3, 3])])
    window.add([], bumps([200 * NS_PER_S, 200 * NS_PER_S + 1], [0, 1]))

    batches = list(window.batches(END_NS))

    found = [bump for batch in batches for bump in batch.bumps]
    assert len(batches) == 2
    assert found == [
        Bump(0, "/a", pressed=True),
        Bump(1, "/b", pressed=False),
        Bump(3, "/b", pressed=True),
        Bump(4, "/a", pressed=False),
        Bump(200 * NS_PER_S + 1, "/a", pressed=True),
    ]


def test_what_may_still_grow_is_kept() -> None:
    """A batch goes when nothing can come into it any more."""
    window = Window(2, {}, changes_only=True)
    window.add(scans(0, 2, 2), [])

    assert list(window.batches(2)) == []
    assert [stamps_of(batch)[0] for batch in window.batches(3)] == [[0, 2, 2]]
    assert list(window.batches(END_NS)) == []


@pytest.mark.parametrize("n_parts", [1, 3])
@given(headers=st.lists(st.integers(0, 9), min_size=9, max_size=9))
def test_late_is_what_an_earlier_one_leaves_behind(n_parts: int, headers: list[int]) -> None:
    """Too late is too far before the latest stamp recorded so far, however the log is cut."""
    arrivals, found = Arrivals(2), []
    recorded = [0, 0, 1, 2, 2, 3, 4, 4, 4]
    for part in np.split(np.arange(9), [2, 5] if n_parts == 3 else []):
        pieces = [
            BumpPiece(np.array(recorded)[part], np.array(headers)[part], part),
            *bumps([], []),
        ]
        found.extend(arrivals.in_time(pieces)[0].tolist())

    latest = [max(h for h, r in zip(headers, recorded, strict=True) if r <= t) for t in recorded]
    assert found == [h >= top - 2 for h, top in zip(headers, latest, strict=True)]
    assert arrivals.settled_ns == latest[-1] - 2
    assert arrivals.in_time([]) == []
