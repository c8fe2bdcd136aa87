"""Logs of simulated scans: alone, beside images, in other containers."""

import struct
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap.writer import Writer
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as DatabaseWriter
from rosbags.typesys import Stores, get_typestore

from mpap_cli.observations import NS_PER_S

SCANS_TOGETHER = 2_600  # about two chunks
_STAMP, _SECONDS = 4, struct.Struct("<i")


def scans_alone(path: Path, to: Path) -> Path:
    """Copy the scans of a log into one of their own, in chunks packed by zstd."""
    with path.open("rb") as source, to.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2")
        channel_id = None
        for schema, channel, message in make_reader(source).iter_messages(topics=["/scan"]):
            if channel_id is None and schema is not None:
                schema_id = writer.register_schema(schema.name, schema.encoding, schema.data)
                channel_id = writer.register_channel(
                    channel.topic, channel.message_encoding, schema_id
                )
            writer.add_message(
                channel_id or 0, message.log_time, message.data, message.publish_time
            )
        writer.finish()  # type: ignore[no-untyped-call]  # the library is half typed
    return to


def repeated(path: Path, to: Path, times: int) -> Path:
    """Copy the scans and bumps of an hour so many times, one hour behind another."""
    with path.open("rb") as source, to.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2")
        messages = list(make_reader(source).iter_messages(topics=["/scan", "/bumper"]))
        channels: dict[int, int] = {}
        for schema, channel, _ in messages:
            if channel.id not in channels and schema is not None:
                known = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, known
                )
        for hour in range(times):
            for _, channel, message in messages:
                payload = message.data
                if channel.topic == "/scan":
                    (seconds,) = _SECONDS.unpack_from(payload, _STAMP)
                    later = _SECONDS.pack(seconds + 3600 * hour)
                    payload = payload[:_STAMP] + later + payload[_STAMP + _SECONDS.size :]
                stamp_ns = message.log_time + 3600 * hour * NS_PER_S
                writer.add_message(channels[channel.id], stamp_ns, payload, stamp_ns)
        writer.finish()  # type: ignore[no-untyped-call]  # the library is half typed
    return to


def beside_images(path: Path, to: Path) -> Path:
    """Copy a log of scans, with 50 kB of noise as an image beside every second scan."""
    rng = np.random.default_rng(0)
    with path.open("rb") as source, to.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2")
        scans = list(make_reader(source).iter_messages())
        schema, channel, _ = scans[0]
        known = writer.register_schema(schema.name, schema.encoding, schema.data) if schema else 0
        of_scans = writer.register_channel(channel.topic, channel.message_encoding, known)
        kind = writer.register_schema("sensor_msgs/msg/CompressedImage", "ros2msg", b"")
        of_images = writer.register_channel("/image", "cdr", kind)
        for begin in range(0, len(scans), SCANS_TOGETHER):
            messages = [message for _, _, message in scans[begin : begin + SCANS_TOGETHER]]
            for message in messages:
                stamp = message.log_time
                writer.add_message(of_scans, stamp, message.data, message.publish_time)
            for message in messages[::2]:
                writer.add_message(of_images, message.log_time, rng.bytes(50_000), 0)
        writer.finish()  # type: ignore[no-untyped-call]  # the library is half typed
    return to


def as_bag(path: Path) -> Path:
    """Copy a log of scans into a bag without compression."""
    to, store = path.with_suffix(".bag"), get_typestore(Stores.ROS1_NOETIC)
    with AnyReader([path]) as reader, BagWriter(to) as bag:
        (scans,) = reader.connections
        name = scans.msgtype
        connection = bag.add_connection(scans.topic, name, typestore=store)
        for _, stamp_ns, raw in reader.messages():
            bag.write(connection, stamp_ns, reader.typestore.cdr_to_ros1(raw, name))
    return to


def as_database(path: Path) -> Path:
    """Copy a log of scans into a folder of rosbag2 with a database."""
    to, store = path.with_suffix(""), get_typestore(Stores.ROS2_HUMBLE)
    with (
        AnyReader([path]) as reader,
        DatabaseWriter(to, version=8, storage_plugin=StoragePlugin.SQLITE3) as database,
    ):
        (scans,) = reader.connections
        connection = database.add_connection(scans.topic, scans.msgtype, typestore=store)
        for _, stamp_ns, raw in reader.messages():
            database.write(connection, stamp_ns, raw)
    return to
