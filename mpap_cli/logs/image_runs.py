"""Camera images of a run of messages."""

from collections import Counter
from typing import NamedTuple

import numpy as np

from mpap_cli.logs.fields import FieldError, TimeSource
from mpap_cli.logs.frames import frame_view
from mpap_cli.logs.raw import RawRun
from mpap_cli.logs.video.links import PacketLinks
from mpap_cli.observations import BoolArray, Frame, IntArray


class FramePiece(NamedTuple):
    """Images that follow one another in log time.

    ``recorded_ns`` (n,) is log time, ``stamps_ns`` (n,) the time wanted, as the frames have it.
    """

    recorded_ns: IntArray
    stamps_ns: IntArray
    frames: tuple[Frame, ...]

    @property
    def n_bytes(self) -> int:
        """Size of the images as recorded."""
        return sum(len(frame.payload) for frame in self.frames)

    def rows(self, rows: IntArray | BoolArray | slice) -> "FramePiece":
        """Return some of the images."""
        numbers = np.arange(len(self.frames))[rows].tolist()
        frames = tuple(self.frames[number] for number in numbers)
        return FramePiece(self.recorded_ns[rows], self.stamps_ns[rows], frames)


def read_frames(
    run: RawRun, time_source: TimeSource = "log", links: PacketLinks | None = None
) -> tuple[FramePiece, Counter[str]]:
    """Read the images of messages, not decoded.

    Parameters
    ----------
    run : RawRun
        Of a type and encoding in `FRAME_READERS`.
    time_source : {"log", "header"}
        Which stamps are wanted.
    links : PacketLinks, optional
        What was read before of the same topic; packets of video go on from there.

    Returns
    -------
    FramePiece
        In log time order; its bytes are copies, so that the run can be let go.
    Counter of str
        Messages that are malformed, by reason; `frame_view` raises FieldError for each.
    """
    links = links or PacketLinks()
    skipped: Counter[str] = Counter()
    kept, frames = [], []
    records = memoryview(run.records)
    columns = (run.stamps_ns.tolist(), run.starts.tolist(), run.sizes.tolist())
    for number, (recorded_ns, start, size) in enumerate(zip(*columns, strict=True)):
        payload = records[start : start + size]
        try:
            frames.append(links.link(frame_view(run.topic, payload, recorded_ns, time_source)))
        except FieldError as error:
            skipped[str(error)] += 1
            links.skip()
        else:
            kept.append(number)
    stamps_ns = np.array([frame.stamp_ns for frame in frames], dtype=np.int64)
    recorded = run.stamps_ns[np.array(kept, dtype=np.int64)]
    return FramePiece(recorded, stamps_ns, tuple(frames)), skipped
