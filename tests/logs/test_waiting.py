"""Events that wait for their batch."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs import waiting
from mpap_cli.logs.image_runs import FramePiece
from mpap_cli.logs.waiting import Waiting, WaitingFrames
from mpap_cli.observations import Frame


def images(*stamps_ns: int, n_bytes: int = 1) -> FramePiece:
    """Return images of one piece, each of some bytes."""
    frames = (Frame(stamp_ns, "mono8", 1, 1, 1, bytes(n_bytes)) for stamp_ns in stamps_ns)
    stamps = np.array(stamps_ns, dtype=np.int64)
    return FramePiece(np.arange(len(stamps)), stamps, tuple(frames))


def stamps_of(pieces: list[FramePiece]) -> list[int]:
    """Return the stamps, which the frames have too."""
    stamps_ns = [int(stamp_ns) for piece in pieces for stamp_ns in piece.stamps_ns]
    assert stamps_ns == [frame.stamp_ns for piece in pieces for frame in piece.frames]
    return stamps_ns


pieces = st.lists(st.integers(0, 20), max_size=5)


@given(added=st.lists(pieces), cuts=st.lists(st.integers(0, 20), max_size=3))
def test_events_come_out_in_time_order(added: list[list[int]], cuts: list[int]) -> None:
    """However they came, each once, and up to the moment asked for."""
    queue: Waiting[FramePiece] = Waiting()
    for stamps_ns in added:
        queue.add([images(*stamps_ns)])
    left = sorted(t for stamps_ns in added for t in stamps_ns)

    for last_ns in [*sorted(cuts), 20]:
        assert queue.first_ns == (left[0] if left else None)
        assert [queue.moment_of(n) for n in range(1, len(left) + 2)] == [*left, None]
        assert stamps_of(queue.take(last_ns)) == [t for t in left if t <= last_ns]
        left = [t for t in left if t > last_ns]


def test_equal_stamps_stay_as_they_came() -> None:
    """Also where others have to be sorted."""
    queue: Waiting[FramePiece] = Waiting()
    queue.add([images(5, 7), images(7, n_bytes=2)])
    queue.add([images(5, n_bytes=3), images(7, n_bytes=4)])

    taken = queue.take(7)

    sizes = [len(frame.payload) for piece in taken for frame in piece.frames]
    assert (stamps_of(taken), sizes) == ([5, 5, 7, 7, 7], [1, 3, 1, 2, 4])


def test_512_images_are_enough() -> None:
    """The last of them makes the batch due; what is taken counts no more."""
    queue = WaitingFrames()
    queue.add([images(*range(500))])
    assert queue.full_ns() is None

    queue.add([images(*range(500, 530))])

    assert queue.full_ns() == 511
    queue.take(100)
    assert queue.full_ns() is None


@pytest.mark.parametrize(("n_bytes", "last"), [(16, 1), (20, 1), (31, 1), (32, 0), (99, 0), (8, 3)])
def test_32_mb_of_images_are_enough(
    monkeypatch: pytest.MonkeyPatch, n_bytes: int, last: int
) -> None:
    """The image with which they are reached makes the batch due, however large it is."""
    monkeypatch.setattr(waiting, "MAX_FRAME_BYTES", 32)
    queue = WaitingFrames()

    queue.add([images(0, 1, n_bytes=n_bytes), images(2, 3, 4, n_bytes=n_bytes)])

    assert queue.full_ns() == last
    queue.take(4)
    assert queue.full_ns() is None
