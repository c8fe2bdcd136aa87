"""Packets of recorded video become pictures, with PyAV (FFmpeg)."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from mpap_cli.errors import UsageError
from mpap_cli.observations import Frame, PacketPlace

if TYPE_CHECKING:
    from av.video.codeccontext import VideoCodecContext
    from av.video.frame import VideoFrame

Picture = NDArray[np.uint8]

DAMAGED = "damaged video"
BEFORE_KEYFRAME = "video before its first keyframe"
AFTER_DAMAGE = "video between damage and the next keyframe"
NO_PICTURE = "video without a picture of its own"

_DECODERS = {"h264": "h264", "h265": "hevc", "vp9": "vp9", "av1": "libdav1d"}
# The largest picture of any level of H.264, H.265 and AV1: 8192 x 4352. A decoder keeps up
# to 17 of them.
_MOST_PIXELS = 8192 * 4352
# The others say by themselves where a picture is damaged.
_OPTIONS = {"h265": {"err_detect": "explode"}}
# A line of packets that is longer may be cut before the next call.
_LONG_LINE = 512
_ALONE = PacketPlace(0, None, opened=True)

_Fed = tuple[Frame, "VideoFrame | str"]
"""A packet, and its picture or why there is none."""


class VideoDecoder:
    """Turns packets of one video into pictures.

    It goes on from the packet that was decoded last, if that is the one before; else it
    begins anew with the first packet that a frame is linked to. So frames give the same
    pictures in a row and one by one.

    Notes
    -----
    What follows a damaged packet is left out up to the next keyframe. Damage that a decoder
    does not notice goes unseen: packets that are missing (H.264, AV1), or that end early
    (some of H.265 and VP9). Pictures that come in
    another order than their packets (B-frames), or later than those, are waited for to the
    end of each call; the next call begins anew, which costs H.265 the leading pictures that
    lean on packets before an open keyframe.
    """

    def __init__(self) -> None:
        self._context: VideoCodecContext | None = None
        self._encoding = ""
        self._last: Frame | None = None
        self._waiting = ""
        self._spoilt_by: int | None = None
        self._flying: dict[int, tuple[Frame, str]] = {}

    def __reduce__(self) -> "tuple[type[VideoDecoder], tuple[()]]":
        """Let a copy begin anew, as it can with any frame."""
        return VideoDecoder, ()

    def decode(self, frames: Sequence[Frame]) -> Iterator[tuple[int, Picture | str]]:
        """Decode frames of one video.

        Parameters
        ----------
        frames : sequence of Frame
            Of encodings in ``VIDEO_ENCODINGS``; some, in about the order in which they
            were recorded. One that has no place is decoded by itself.

        Yields
        ------
        tuple of int and (ndarray of shape (h, w, 3), uint8, or str)
            Which of the frames, each once; its picture in BGR, or why it has none. They
            come as they are done.

        Raises
        ------
        UsageError
            If PyAV is missing.
        """
        wanted = {id(frame): position for position, frame in enumerate(frames)}
        for frame in frames:
            if id(frame) not in wanted or _place(frame).number in self._flying:
                continue
            path = self._path(frame)
            if not self._follows(path[0]):
                yield from _taken(wanted, self._drain(wanted))
                self._begin_with(path[0])
            for packet in path:
                yield from _taken(wanted, self._feed(packet))
        yield from _taken(wanted, self._drain(wanted))
        reasons = {id(frame): reason for frame, reason in self._flying.values()}
        for key, position in wanted.items():
            yield position, reasons.get(key) or NO_PICTURE
        self._flying.clear()

    def _path(self, frame: Frame) -> list[Frame]:
        """Return the packets to decode for a frame, its own last."""
        path = [frame]
        while (before := _place(path[-1]).before) is not None and before is not self._last:
            path.append(before)
        return path[::-1]

    def _follows(self, frame: Frame) -> bool:
        """Tell whether a packet is the next after the one that was decoded last."""
        if self._last is None or frame.encoding != self._encoding:
            return False
        return _place(frame).number == _place(self._last).number + 1

    def _begin_with(self, first: Frame) -> None:
        """Make ready for a packet that does not follow the last."""
        lost_base = BEFORE_KEYFRAME if self._last is None else AFTER_DAMAGE
        self._waiting = "" if _place(first).opened else lost_base
        self._spoilt_by = None
        self._flying.clear()
        if first.encoding != self._encoding:
            self._encoding, self._context = first.encoding, _open(first.encoding)
        self._opened().flush_buffers()

    def _feed(self, frame: Frame) -> Iterator[_Fed]:
        """Decode one packet; yield what is done now."""
        from av import Packet  # noqa: PLC0415  # an extra
        from av.error import FFmpegError  # noqa: PLC0415

        self._last, number = frame, _place(frame).number
        spoilt = self._spoilt_by is not None
        self._flying[number] = frame, AFTER_DAMAGE if spoilt else self._waiting
        pictures: list[VideoFrame] = []
        try:
            if frame.payload:  # an empty packet would mean that the video ends
                packet = Packet(frame.payload)
                packet.pts = number
                pictures = self._opened().decode(packet)
        except FFmpegError:
            if frame.encoding == "av1":  # its decoder would return to the same error for ever
                self._opened().flush_buffers()
            broken = True
        else:  # each packet of AV1 shows a picture, at once
            broken = not frame.payload or (frame.encoding == "av1" and not pictures)
        if broken:
            _, reason = self._flying.pop(number)
            self._spoilt_by = self._spoilt_by if reason else number
            yield frame, reason or DAMAGED
        yield from self._landed(pictures)

    def _landed(self, pictures: "Sequence[VideoFrame]") -> Iterator[_Fed]:
        """Yield pictures with their packets; one that is damaged spoils those after it."""
        for picture in pictures:
            if picture.pts is None or picture.pts not in self._flying:
                continue
            frame, _ = self._flying.pop(picture.pts)
            spoilt = self._spoilt_by is not None and picture.pts > self._spoilt_by
            if picture.is_corrupt:
                self._spoilt_by = self._spoilt_by if spoilt else picture.pts
                yield frame, AFTER_DAMAGE if spoilt else DAMAGED
            elif spoilt and not picture.key_frame:
                yield frame, AFTER_DAMAGE
            else:
                self._spoilt_by = None if spoilt else self._spoilt_by
                self._waiting = ""
                yield frame, picture

    def _drain(self, wanted: dict[int, int]) -> Iterator[_Fed]:
        """Yield the wanted pictures that the decoder still holds back, if it can begin anew."""
        from av.error import FFmpegError  # noqa: PLC0415  # an extra

        held = any(id(frame) in wanted for frame, _ in self._flying.values())
        if not (held and self._opened().has_b_frames and _can_return(self._last)):
            return
        try:
            pictures = self._opened().decode(None)
        except FFmpegError:
            pictures = []
        yield from self._landed(pictures)
        self._last = None

    def _opened(self) -> "VideoCodecContext":
        if self._context is None:
            msg = "a packet is decoded before a decoder is there"
            raise RuntimeError(msg)
        return self._context


def _place(frame: Frame) -> PacketPlace:
    return frame.place or _ALONE


def _can_return(frame: Frame | None) -> bool:
    """Tell whether the packet behind a frame can still be decoded if the decoder begins anew."""
    if frame is None or not _place(frame).opened:
        return False
    n_linked = 1
    while (before := _place(frame).before) is not None:
        frame, n_linked = before, n_linked + 1
    return n_linked <= _LONG_LINE


def _open(encoding: str) -> "VideoCodecContext":
    """Make a decoder of one thread, which shows each picture as soon as it can."""
    try:
        import av  # noqa: PLC0415  # an extra

        context = cast("VideoCodecContext", av.CodecContext.create(_DECODERS[encoding], "r"))
    except (ImportError, ValueError) as err:  # missing, or built without the decoder
        msg = f'{encoding} video: {err}; pip install "mpap[video]"'
        raise UsageError(msg) from err
    context.thread_count = 1
    context.options = {"max_pixels": str(_MOST_PIXELS), **_OPTIONS.get(encoding, {})}
    return context


def _taken(wanted: dict[int, int], fed: Iterator[_Fed]) -> Iterator[tuple[int, Picture | str]]:
    """Yield what is wanted, and strike it off."""
    for frame, found in fed:
        position = wanted.pop(id(frame), None)
        if position is not None:
            yield position, _pixels(found)


def _pixels(found: "VideoFrame | str") -> Picture | str:
    """Turn a picture into BGR."""
    from av.error import FFmpegError  # noqa: PLC0415  # an extra

    if isinstance(found, str):
        return found
    try:
        return np.asarray(found.to_ndarray(format="bgr24"), np.uint8)
    except FFmpegError:
        return DAMAGED
