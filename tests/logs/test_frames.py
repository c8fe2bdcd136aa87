"""Images out of messages of every type and encoding."""

import base64
import json
from contextlib import suppress
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs.fields import FieldError
from mpap_cli.logs.frames import FRAME_READERS, frame_view, read_frame
from mpap_cli.logs.raw import PayloadError, Topic
from mpap_cli.logs.writing.encoding import RosEncoder
from mpap_cli.observations import Frame
from tests import protobufs
from tests.videos import (
    DEPTHAI,
    FOXGLOVE,
    FOXGLOVE_ROS,
    TRANSPORT,
    VideoMessages,
    as_json,
    as_protobuf,
)

RAW, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
FOXGLOVE_RAW, FOXGLOVE_COMPRESSED = "foxglove.RawImage", "foxglove.CompressedImage"
ENCODERS = {"ros1": RosEncoder(1), "cdr": RosEncoder(2)}
PIXELS = bytes(range(2 * 10))
RECORDED_NS = 50
STAMP_NS = 7_000_000_005
JPEG = b"\xff\xd8\xff\xe0 and so on"


def topic(msgtype: str, encoding: str) -> Topic:
    """Return a topic of images."""
    if encoding == "protobuf" and msgtype in protobufs.TYPES:
        return protobufs.topic("/camera", msgtype)
    return Topic("/camera", msgtype, encoding, 1, "", "")


def encode(encoding: str, msgtype: str, /, **fields: Any) -> bytes:
    """Return a message; ``big`` is big-endian CDR."""
    encoder = ENCODERS["ros1" if encoding == "ros1" else "cdr"]
    header = {"stamp": {"sec": 7, "nanosec": 5}, "frame_id": fields.pop("frame_id", "camera")}
    content = np.frombuffer(fields.pop("data"), np.uint8)
    payload = encoder.encode(msgtype, {"header": header, "data": content, **fields})
    if encoding == "big":
        decoded = encoder.store.deserialize_cdr(payload, msgtype)
        payload = bytes(encoder.store.serialize_cdr(decoded, msgtype, little_endian=False))
    return payload


def encode_raw(encoding: str, /, **fields: Any) -> bytes:
    """Return a raw image of 2 rows of 10 bytes."""
    size = {"height": 2, "width": 3, "step": 10, "encoding": "rgb8", "data": PIXELS}
    return encode(encoding, RAW, **{**size, **fields})


def encode_json(**fields: Any) -> bytes:
    """Return an image of foxglove."""
    stamp = {"sec": 7, "nsec": 5}
    image = {"timestamp": stamp, "width": 3, "height": 2, "encoding": "rgb8", "step": 10}
    image["data"] = base64.b64encode(PIXELS).decode()
    return json.dumps({**image, **fields}).encode()


RAW_FIELDS = {"width": 3, "height": 2, "encoding": "rgb8", "step": 10}


def encode_protobuf(msgtype: str, **fields: Any) -> bytes:
    """Return an image of foxglove in protobuf."""
    return protobufs.payload(msgtype, STAMP_NS, **{"data": PIXELS, **fields})


def view(payload: bytes, msgtype: str, encoding: str, **words: Any) -> Frame:
    """Read an image."""
    form = "cdr" if encoding == "big" else encoding
    return frame_view(topic(msgtype, form), memoryview(payload), RECORDED_NS, **words)


@pytest.mark.parametrize("frame_id", ["", "a", "camera", "camera_optical"])
@pytest.mark.parametrize("encoding", ["cdr", "big", "ros1"])
def test_raw_image_keeps_rows_with_padding(encoding: str, frame_id: str) -> None:
    """Size, encoding and all bytes are as recorded, wherever they lie."""
    payload = encode_raw(encoding, frame_id=frame_id)

    assert view(payload, RAW, encoding) == Frame(RECORDED_NS, "rgb8", 3, 2, 10, PIXELS)


@pytest.mark.parametrize("form", ["", "jpeg", "rgb8; jpeg compressed bgr8"])
@pytest.mark.parametrize("encoding", ["cdr", "big", "ros1"])
def test_compressed_image_is_its_bytes(encoding: str, form: str) -> None:
    """What the driver writes of the format does not matter."""
    payload = encode(encoding, COMPRESSED, format=form, data=JPEG)

    assert view(payload, COMPRESSED, encoding) == Frame(RECORDED_NS, "compressed", 0, 0, 0, JPEG)


def test_images_of_foxglove() -> None:
    """Their bytes are base64."""
    kinds = (FOXGLOVE_RAW, FOXGLOVE_COMPRESSED)

    raw, compressed = (view(encode_json(), kind, "json") for kind in kinds)

    assert raw == Frame(RECORDED_NS, "rgb8", 3, 2, 10, PIXELS)
    assert compressed == Frame(RECORDED_NS, "compressed", 0, 0, 0, PIXELS)


@pytest.mark.parametrize(
    ("payload", "msgtype", "encoding"),
    [
        (encode_raw("cdr"), RAW, "cdr"),
        (encode_raw("ros1"), RAW, "ros1"),
        (encode("big", COMPRESSED, data=JPEG), COMPRESSED, "big"),
        (encode_json(), FOXGLOVE_RAW, "json"),
        (encode_json(), FOXGLOVE_COMPRESSED, "json"),
    ],
)
def test_stamp_of_the_header_on_demand(payload: bytes, msgtype: str, encoding: str) -> None:
    """Otherwise it is log time."""
    assert view(payload, msgtype, encoding, time_source="header").stamp_ns == STAMP_NS
    assert view(payload, msgtype, encoding).stamp_ns == RECORDED_NS


@pytest.mark.parametrize(
    ("pixels", "swapped"),
    [("mono16", True), ("rgba16", True), ("bayer_grbg16", True), ("16UC1", True), ("16SC3", True),
     ("mono8", False), ("yuv422", False), ("8UC3", False)],
)  # fmt: skip
def test_numbers_of_16_bits_come_out_little_endian(pixels: str, swapped: bool) -> None:
    """The message says that they are big endian; bytes have no order."""
    expected = np.frombuffer(PIXELS, ">u2").astype("<u2").tobytes() if swapped else PIXELS

    frame = view(encode_raw("cdr", encoding=pixels, is_bigendian=1), RAW, "cdr")

    assert frame.payload == expected
    assert view(encode_raw("cdr", encoding=pixels), RAW, "cdr").payload == PIXELS


@pytest.mark.parametrize("fields", [{"step": 9}, {"data": PIXELS[:-1]}])
def test_big_endian_rows_of_an_odd_length_are_refused(fields: dict[str, Any]) -> None:
    """Which bytes make a number cannot be told."""
    payload = encode_raw("ros1", encoding="mono16", is_bigendian=1, **fields)

    with pytest.raises(FieldError, match=r"^an image of 16 bits a pixel whose rows"):
        view(payload, RAW, "ros1")


@pytest.mark.parametrize("encoding", ["cdr", "big", "ros1"])
@pytest.mark.parametrize("msgtype", [RAW, COMPRESSED])
def test_image_cut_anywhere_is_refused(msgtype: str, encoding: str) -> None:
    """No length in the message is believed beyond its end."""
    payload = encode_raw(encoding) if msgtype == RAW else encode(encoding, msgtype, data=JPEG)

    for size in range(len(payload)):
        with pytest.raises(FieldError, match=r"^an image (cut short|that is no plain CDR)$"):
            view(payload[:size], msgtype, encoding)


@pytest.mark.parametrize(
    ("payload", "time_source"),
    [
        (b"", "log"),
        (b"\xff{}", "log"),
        (b"[1]", "log"),
        (b"[" * 100_000, "log"),
        (encode_json(data="not base64!"), "log"),
        (encode_json(data=None), "log"),
        (encode_json(width=-1), "log"),
        (encode_json(step=2**40), "log"),
        (encode_json(height="x"), "log"),
        (encode_json(timestamp=None), "header"),
        (encode_json(timestamp={"sec": 10**15, "nsec": 0}), "header"),
        (b'{"data": "", "width": 1e999, "height": 1, "step": 1, "encoding": "a"}', "log"),
    ],
)
def test_json_that_is_no_image_is_refused(
    payload: bytes, time_source: Literal["log", "header"]
) -> None:
    """Whatever is wrong with it."""
    with pytest.raises(FieldError, match=r"^an image that does not follow foxglove\.RawImage$"):
        view(payload, FOXGLOVE_RAW, "json", time_source=time_source)


def test_protobuf_image_has_its_bytes_and_its_form() -> None:
    """Log time or the stamp inside, as is wanted."""
    raw = encode_protobuf(FOXGLOVE_RAW, **RAW_FIELDS)
    packed = encode_protobuf(FOXGLOVE_COMPRESSED, data=JPEG, format="jpeg")

    by_log = view(raw, FOXGLOVE_RAW, "protobuf")
    by_header = view(packed, FOXGLOVE_COMPRESSED, "protobuf", time_source="header")

    assert by_log == Frame(RECORDED_NS, "rgb8", 3, 2, 10, PIXELS)
    assert by_header == Frame(STAMP_NS, "compressed", 0, 0, 0, JPEG)


def test_protobuf_image_without_a_schema_is_refused() -> None:
    """Numbers of fields alone say nothing."""
    bare = Topic("/camera", FOXGLOVE_RAW, "protobuf", 1, "", "")

    with pytest.raises(FieldError, match=r"^an image that does not follow foxglove\.RawImage$"):
        frame_view(bare, memoryview(encode_protobuf(FOXGLOVE_RAW, **RAW_FIELDS)), 0)


WHOLE = {
    (RAW, "cdr"): encode_raw("cdr", is_bigendian=1, encoding="mono16"),
    (RAW, "ros1"): encode_raw("ros1"),
    (COMPRESSED, "cdr"): encode("big", COMPRESSED, data=JPEG),
    (COMPRESSED, "ros1"): encode("ros1", COMPRESSED, data=JPEG),
    (FOXGLOVE_RAW, "json"): encode_json(),
    (FOXGLOVE_COMPRESSED, "json"): encode_json(),
    (FOXGLOVE, "json"): as_json(PIXELS, "h264", STAMP_NS),
    (FOXGLOVE, "protobuf"): as_protobuf(PIXELS, "h264", STAMP_NS),
    (FOXGLOVE_RAW, "protobuf"): encode_protobuf(FOXGLOVE_RAW, **RAW_FIELDS),
    (FOXGLOVE_COMPRESSED, "protobuf"): encode_protobuf(FOXGLOVE_COMPRESSED, format="jpeg"),
    (FOXGLOVE_ROS, "cdr"): VideoMessages(2).ros(FOXGLOVE_ROS, PIXELS, "h264", STAMP_NS),
    (FOXGLOVE_ROS, "ros1"): VideoMessages(1).ros(FOXGLOVE_ROS, PIXELS, "h264", STAMP_NS),
    (TRANSPORT, "cdr"): VideoMessages(2).ros(TRANSPORT, PIXELS, "h264", STAMP_NS),
    (DEPTHAI, "cdr"): VideoMessages(2).ros(TRANSPORT, PIXELS, "h264", STAMP_NS),
    (DEPTHAI, "ros1"): VideoMessages(1).ros(TRANSPORT, PIXELS, "h264", STAMP_NS),
}


@given(
    kind=st.sampled_from(sorted(WHOLE)),
    place=st.integers(0, 100),
    noise=st.binary(max_size=8),
    time_source=st.sampled_from(["log", "header"]),
)
def test_broken_message_makes_an_image_or_a_field_error(
    kind: tuple[str, str], place: int, noise: bytes, time_source: Literal["log", "header"]
) -> None:
    """No other exception leaves the reader, and it reads nothing but the message."""
    whole = WHOLE[kind]
    payload = whole[:place] + noise + whole[place + len(noise) :]

    with suppress(FieldError):
        assert len(view(payload, *kind, time_source=time_source).payload) <= len(payload)


def test_every_kind_of_image_is_tried() -> None:
    """The broken ones above are of all types and encodings."""
    assert WHOLE.keys() == FRAME_READERS.keys()


def test_unknown_encoding_is_refused() -> None:
    """A topic may have a second channel in another encoding."""
    with pytest.raises(FieldError, match=r"^an image in encoding protobuf$"):
        view(b"", RAW, "protobuf")
    with pytest.raises(FieldError, match=r"^an image in encoding unknown$"):
        view(b"", RAW, "")


def test_one_message_is_read_with_the_name_of_its_log(make_log: Any) -> None:
    """The error names log and topic."""
    reader = make_log([("/camera", RAW, 3, {"data": np.arange(4, dtype=np.uint8)})])
    (message,) = reader.messages({"/camera"})

    assert read_frame(reader, message).payload == bytes(range(4))
    with pytest.raises(PayloadError, match=r"^log\.mcap: /camera: an image cut short$"):
        read_frame(reader, message._replace(payload=message.payload[:-1]))
