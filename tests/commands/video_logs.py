"""Logs whose images are video, made of the camera fixture by the field's own libraries."""

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import cv2
import numpy as np
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as FolderWriter
from rosbags.typesys import get_types_from_msg

from mpap_cli.features.images.image_decode import decode_frame
from mpap_cli.features.images.video_decode import Picture
from mpap_cli.logs.frames import read_frame
from mpap_cli.logs.reader import RawMessage, Topic, open_log
from mpap_cli.logs.writing.encoding import RosEncoder
from tests import protobufs
from tests.commands.camera_runs import CAMERA_A
from tests.videos import (
    FOXGLOVE,
    FOXGLOVE_ROS,
    TRANSPORT,
    VideoMessages,
    as_json,
    as_protobuf,
    encode_video,
)

CAMERA, COMPRESSED = "/camera/image_raw/compressed", "sensor_msgs/msg/CompressedImage"
VIDEO = "/camera/image_raw/ffmpeg"
OTHERS = ("/scan", "/events/bumper", "/odom", "/tf_static")
N_IMAGES = 60

Packet = tuple[int, int, bytes]
"""Log time, stamp of its picture, and the bytes."""
Image = tuple[Topic, Callable[[Packet], bytes]]
"""A topic of images, and what makes its messages of packets."""

_ROS = VideoMessages(2)


def image_topic(kind: str, codec: str = "h264") -> Image:
    """Return how one kind of messages carries packets, or PNG images."""
    if kind == "png":
        encoder = RosEncoder(2)
        text = encoder.definition(COMPRESSED)[0]
        topic = Topic(VIDEO, COMPRESSED, "cdr", 0, text, "ros2msg")
        return topic, lambda packet: encoder.encode(COMPRESSED, _png_fields(packet))
    if kind == "protobuf":
        topic = protobufs.topic(VIDEO, FOXGLOVE, 0)
        return topic, lambda packet: as_protobuf(packet[2], codec, packet[1])
    if kind == "json":
        topic = Topic(VIDEO, FOXGLOVE, kind, 0, "{}", "jsonschema")
        return topic, lambda packet: as_json(packet[2], codec, packet[1])
    msgtype, words = {
        "foxglove": (FOXGLOVE_ROS, codec),
        "transport": (TRANSPORT, f"{codec};yuv420p;bgr8;bgr8"),
    }[kind]
    text, _ = _ROS.store.generate_msgdef(msgtype, ros_version=2)
    topic = Topic(VIDEO, msgtype, "cdr", 0, text, "ros2msg")
    return topic, lambda packet: _ROS.ros(msgtype, packet[2], words, packet[1])


def _png_fields(packet: Packet) -> dict[str, object]:
    """Return a PNG image as a driver writes it."""
    return {"format": "png", "data": np.frombuffer(packet[2], np.uint8)}


@cache
def recorded() -> tuple[tuple[RawMessage, ...], tuple[Picture, ...], tuple[int, ...]]:
    """Return the messages of the fixture but for its camera, its pictures and their stamps."""
    with open_log(CAMERA_A) as reader:
        others = tuple(reader.messages(OTHERS))
        messages = list(reader.messages({CAMERA}))
        pictures = tuple(decode_frame(read_frame(reader, message)) for message in messages)
    whole = tuple(picture for picture in pictures if picture is not None)
    assert len(whole) == N_IMAGES
    return others, whole, tuple(message.stamp_ns for message in messages)


@cache
def video_packets(codec: str = "h264", b_frames: int = 0) -> tuple[Packet, ...]:
    """Return the packets of the fixture's pictures, recorded one by one."""
    _, pictures, stamps_ns = recorded()
    packets = encode_video(codec, pictures, b_frames=b_frames)
    return tuple(
        (recorded_ns, stamps_ns[number], packet)
        for recorded_ns, (packet, number) in zip(stamps_ns, packets, strict=True)
    )


def png_packets(pictures: Sequence[Picture]) -> list[Packet]:
    """Return pictures as PNG images with the stamps of the fixture."""
    _, _, stamps_ns = recorded()
    return [
        (stamp_ns, stamp_ns, bytes(cv2.imencode(".png", picture)[1]))
        for stamp_ns, picture in zip(stamps_ns, pictures, strict=True)
    ]


def write_mcap(path: Path, image: Image, packets: Sequence[Packet], *, scans: bool = True) -> Path:
    """Write a log as MCAP, with the fixture's scans, bumps and odometry or without."""
    topic, make = image
    others = [message for message in recorded()[0] if scans]
    images = [RawMessage(topic, packet[0], make(packet)) for packet in packets]
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("wb") as stream:
        writer = McapWriter(stream)
        writer.start("ros2")
        channels = {}
        for name, one in {m.topic.name: m.topic for m in (*others, *images)}.items():
            is_protobuf = one.encoding == "protobuf"
            text = protobufs.schema(one.msgtype) if is_protobuf else one.definition.encode()
            schema = writer.register_schema(one.msgtype, one.definition_format, text)
            channels[name] = writer.register_channel(name, one.encoding, schema)
        for message in sorted([*others, *images], key=lambda message: message.stamp_ns):
            stamp_ns = message.stamp_ns
            writer.add_message(channels[message.topic.name], stamp_ns, message.payload, stamp_ns)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type
    return path


def write_folder(path: Path, image: Image, packets: Sequence[Packet]) -> Path:
    """Write a log as a rosbag2 folder of sqlite3."""
    topic, make = image
    images = [RawMessage(topic, packet[0], make(packet)) for packet in packets]
    messages = sorted([*recorded()[0], *images], key=lambda message: message.stamp_ns)
    store = VideoMessages(2).store
    with FolderWriter(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connections = {}
        for name, one in {m.topic.name: m.topic for m in messages}.items():
            if one.msgtype not in store.fielddefs:
                store.register(get_types_from_msg(one.definition, one.msgtype))
            connections[name] = writer.add_connection(name, one.msgtype, typestore=store)
        for message in messages:
            writer.write(connections[message.topic.name], message.stamp_ns, message.payload)
    return path
