"""Packets of video out of messages."""

import re
from collections.abc import Callable

from mpap_cli.logs.cursor import Cursor
from mpap_cli.logs.fields import LOCATED
from mpap_cli.logs.raw import Topic
from mpap_cli.observations import Frame

FOXGLOVE_VIDEO = "foxglove.CompressedVideo"
_WHAT = "an image"
_CODECS = {
    "h264": re.compile(r"264|^$"),
    "h265": re.compile(r"265|hevc"),
    "vp9": re.compile(r"vp9"),
    "av1": re.compile(r"av1"),
}
PacketReader = Callable[[memoryview, Topic, int | None], Frame]


def video_encoding(words: str) -> str:
    """Return which of ``VIDEO_ENCODINGS`` a message speaks of, or its words as they are.

    Parameters
    ----------
    words : str
        A codec or an encoder, perhaps followed by pixel formats behind semicolons; nothing
        means h264, which Foxglove knew first.

    Examples
    --------
    >>> video_encoding("libx264"), video_encoding("hevc_nvenc;yuv420p;bgr8;bgr8")
    ('h264', 'h265')

    A picture whose gray is the mosaic of a sensor would need its pattern:

    >>> video_encoding("h264;gray;bayer_rggb8;bayer_rggb8")
    'h264;gray;bayer_rggb8;bayer_rggb8'
    """
    codec, _, formats = words.partition(";")
    if "gray;bayer" in formats:
        return words
    for encoding, pattern in _CODECS.items():
        if pattern.search(codec.lower()):
            return encoding
    return words


def _packet(stamp_ns: int, words: str, content: memoryview) -> Frame:
    return Frame(stamp_ns, video_encoding(words), 0, 0, 0, bytes(content))


def _compressed_video(payload: memoryview, topic: Topic, stamp_ns: int | None) -> Frame:
    """foxglove_msgs/CompressedVideo: its stamp stands where others have a header."""
    at = Cursor(payload, topic.encoding, _WHAT, headed=False)
    own_ns = at.stamp_ns()
    at.sequence()  # frame_id
    content = at.sequence()
    return _packet(own_ns if stamp_ns is None else stamp_ns, at.text(), content)


def _transport_packet(payload: memoryview, topic: Topic, stamp_ns: int | None) -> Frame:
    """FFMPEGPacket of ffmpeg_image_transport, and of depthai, which has the same fields."""
    at = Cursor(payload, topic.encoding, _WHAT)
    header_ns = at.stamp_ns()
    at.sequence()  # frame_id
    at.number(), at.number()  # width and height, which the packets tell too
    words = at.text()
    at.doubles(1)  # pts, a number of 8 bytes
    at.byte(), at.byte()  # flags, is_bigendian
    return _packet(header_ns if stamp_ns is None else stamp_ns, words, at.sequence())


VIDEO_READERS: dict[tuple[str, str], PacketReader] = {
    **{("foxglove_msgs/msg/CompressedVideo", encoding): _compressed_video for encoding in LOCATED},
    # in ROS 1 it had other fields
    ("ffmpeg_image_transport_msgs/msg/FFMPEGPacket", "cdr"): _transport_packet,
    **{("depthai_ros_msgs/msg/FFMPEGPacket", encoding): _transport_packet for encoding in LOCATED},
}
"""Of ROS messages, by type and encoding; as the readers of images."""
VIDEO_TYPES = frozenset({FOXGLOVE_VIDEO, *(msgtype for msgtype, _ in VIDEO_READERS)})
