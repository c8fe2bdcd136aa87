"""Real video of made-up pictures, and logs that carry it."""

import base64
import json
import os
from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import cache
from typing import Any, cast

import av
import cv2
import numpy as np
from av.video.codeccontext import VideoCodecContext
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from mpap_cli.features.images.video_decode import Picture, VideoDecoder
from mpap_cli.logs.video.links import PacketLinks
from mpap_cli.observations import NS_PER_S, Frame
from tests.protobufs import payload

os.environ.setdefault("SVT_LOG", "0")  # the encoder of AV1 is talkative

ENCODERS: dict[str, tuple[str, dict[str, str]]] = {
    "h264": ("libx264", {"preset": "ultrafast"}),
    "h265": ("libx265", {"preset": "ultrafast", "x265-params": "log-level=none:pools=1"}),
    "vp9": ("libvpx-vp9", {"deadline": "realtime", "cpu-used": "8", "lag-in-frames": "0"}),
    "av1": ("libsvtav1", {"preset": "12", "svtav1-params": "lp=1"}),
}
CODECS = tuple(ENCODERS)
KEY_EVERY, N_PICTURES = 8, 20
FOXGLOVE, FOXGLOVE_ROS = "foxglove.CompressedVideo", "foxglove_msgs/msg/CompressedVideo"
TRANSPORT = "ffmpeg_image_transport_msgs/msg/FFMPEGPacket"
DEPTHAI = "depthai_ros_msgs/msg/FFMPEGPacket"
DEFINITIONS = {
    FOXGLOVE_ROS: (
        "builtin_interfaces/Time timestamp\nstring frame_id\nuint8[] data\nstring format\n"
    ),
    TRANSPORT: (
        "std_msgs/Header header\nint32 width\nint32 height\nstring encoding\nuint64 pts\n"
        "uint8 flags\nbool is_bigendian\nuint8[] data\n"
    ),
}


def ride(n_pictures: int, width: int, height: int, seed: int = 0) -> list[Picture]:
    """Return pictures of a camera that is moved along a wall."""
    rng = np.random.default_rng(seed)
    coarse = rng.integers(0, 256, (height // 8, 4 * width // 8, 3), dtype=np.uint8)
    wall = cv2.resize(coarse, (4 * width, height), interpolation=cv2.INTER_CUBIC)
    return [np.array(wall[:, 2 * n : 2 * n + width], np.uint8) for n in range(n_pictures)]


def encode_video(
    codec: str, pictures: Sequence[Picture], *, key_every: int = KEY_EVERY, b_frames: int = 0
) -> list[tuple[bytes, int]]:
    """Return packets in the order of a log, each with the number of its picture."""
    name, options = ENCODERS[codec]
    encoder = cast("VideoCodecContext", av.CodecContext.create(name, "w"))
    encoder.height, encoder.width = pictures[0].shape[:2]
    encoder.pix_fmt = "yuv420p"
    encoder.time_base, encoder.framerate = Fraction(1, 30), Fraction(30, 1)
    encoder.gop_size, encoder.max_b_frames = key_every, b_frames
    encoder.options = options
    packets = []
    for number, picture in enumerate(pictures):
        frame = av.VideoFrame.from_ndarray(picture, format="bgr24")
        frame.pts = number
        packets += encoder.encode(frame)
    packets += encoder.encode(None)
    return [(bytes(packet), cast("int", packet.pts)) for packet in packets]


@cache
def packets_of(codec: str, b_frames: int = 0) -> tuple[bytes, ...]:
    """Return the packets of a short ride of 96 x 64 pixels, a keyframe every 8."""
    pictures = ride(N_PICTURES, 96, 64)
    return tuple(packet for packet, _ in encode_video(codec, pictures, b_frames=b_frames))


def linked(codec: str, packets: Iterable[bytes], links: PacketLinks | None = None) -> list[Frame]:
    """Return packets as frames of one video, a nanosecond apart."""
    links = links or PacketLinks()
    frames = (Frame(n, codec, 0, 0, 0, packet) for n, packet in enumerate(packets))
    return [links.link(frame) for frame in frames]


def decoded(frames: list[Frame], decoder: VideoDecoder | None = None) -> list[Picture | str]:
    """Return what becomes of each frame."""
    found = dict((decoder or VideoDecoder()).decode(frames))
    assert sorted(found) == list(range(len(frames)))
    return [found[number] for number in range(len(frames))]


def pictures(frames: list[Frame], decoder: VideoDecoder | None = None) -> list[Picture]:
    """Return the picture of each frame; all have one."""
    found = decoded(frames, decoder)
    assert not [one for one in found if isinstance(one, str)]
    return [one for one in found if not isinstance(one, str)]


class VideoMessages:
    """Messages of every type that carries video, as bytes."""

    def __init__(self, ros_version: int = 2) -> None:
        self.store = get_typestore(Stores.ROS2_HUMBLE if ros_version == 2 else Stores.ROS1_NOETIC)
        for msgtype, definition in DEFINITIONS.items():
            self.store.register(get_types_from_msg(definition, msgtype))
        self._ros_version = ros_version

    def ros(
        self, msgtype: str, packet: bytes, words: str, stamp_ns: int, *, little: bool = True
    ) -> bytes:
        """Return a message of ROS: cdr, or as ROS 1 writes it."""
        types = self.store.types
        time = types["builtin_interfaces/msg/Time"](*divmod(stamp_ns, NS_PER_S))
        content = np.frombuffer(packet, np.uint8)
        message: object
        if msgtype == FOXGLOVE_ROS:
            message = types[msgtype](time, "camera", content, words)
        else:
            before = (7,) if self._ros_version == 1 else ()
            header = types["std_msgs/msg/Header"](*before, time, "camera")
            message = types[msgtype](header, 96, 64, words, 3, 1, False, content)
        if self._ros_version == 1:
            return bytes(self.store.serialize_ros1(message, msgtype))
        return bytes(self.store.serialize_cdr(message, msgtype, little_endian=little))


def as_json(packet: bytes, words: str, stamp_ns: int) -> bytes:
    """Return foxglove.CompressedVideo in JSON."""
    sec, nsec = divmod(stamp_ns, NS_PER_S)
    message: dict[str, Any] = {"timestamp": {"sec": sec, "nsec": nsec}, "frame_id": "camera"}
    return json.dumps(
        {**message, "data": base64.b64encode(packet).decode(), "format": words}
    ).encode()


def as_protobuf(packet: bytes, words: str, stamp_ns: int) -> bytes:
    """Return foxglove.CompressedVideo in protobuf."""
    return payload(FOXGLOVE, stamp_ns, frame_id="camera", data=packet, format=words)
