"""Packets of video out of messages of every type."""

from collections.abc import Callable

import pytest

from mpap_cli.logs.fields import FieldError
from mpap_cli.logs.frames import frame_view
from mpap_cli.logs.raw import Topic
from mpap_cli.logs.video.packets import video_encoding
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

CDR, ROS1 = VideoMessages(2), VideoMessages(1)
PACKET, RECORDED_NS, STAMP_NS = b"\0\0\1\x65 and so on", 50, 7_000_000_005

Message = Callable[[str], bytes]
MESSAGES: dict[tuple[str, str, str], Message] = {
    ("json", FOXGLOVE, ""): lambda words: as_json(PACKET, words, STAMP_NS),
    ("protobuf", FOXGLOVE, ""): lambda words: as_protobuf(PACKET, words, STAMP_NS),
    ("cdr", FOXGLOVE_ROS, ""): lambda words: CDR.ros(FOXGLOVE_ROS, PACKET, words, STAMP_NS),
    ("cdr", FOXGLOVE_ROS, "big"): (
        lambda words: CDR.ros(FOXGLOVE_ROS, PACKET, words, STAMP_NS, little=False)
    ),
    ("ros1", FOXGLOVE_ROS, ""): lambda words: ROS1.ros(FOXGLOVE_ROS, PACKET, words, STAMP_NS),
    ("cdr", TRANSPORT, ""): lambda words: CDR.ros(TRANSPORT, PACKET, words, STAMP_NS),
    ("cdr", TRANSPORT, "big"): (
        lambda words: CDR.ros(TRANSPORT, PACKET, words, STAMP_NS, little=False)
    ),
    ("cdr", DEPTHAI, ""): lambda words: CDR.ros(TRANSPORT, PACKET, words, STAMP_NS),
    ("ros1", DEPTHAI, ""): lambda words: ROS1.ros(TRANSPORT, PACKET, words, STAMP_NS),
}


def topic(msgtype: str, encoding: str) -> Topic:
    """Return a topic of video."""
    if encoding == "protobuf":
        return protobufs.topic("/camera", msgtype)
    return Topic("/camera", msgtype, encoding, 1, "", "")


@pytest.mark.parametrize("kind", MESSAGES)
@pytest.mark.parametrize("words", ["h264", "h265", "hevc_nvenc;yuv420p;bgr8;bgr8"])
def test_packet_is_its_bytes_with_stamp_and_codec(kind: tuple[str, str, str], words: str) -> None:
    """Log time or the stamp inside, as is wanted; the width of the message does not count."""
    encoding, msgtype, _ = kind
    payload = memoryview(MESSAGES[kind](words))
    codec = "h264" if words == "h264" else "h265"

    by_log = frame_view(topic(msgtype, encoding), payload, RECORDED_NS)
    by_header = frame_view(topic(msgtype, encoding), payload, RECORDED_NS, "header")

    assert by_log == Frame(RECORDED_NS, codec, 0, 0, 0, PACKET)
    assert by_header == Frame(STAMP_NS, codec, 0, 0, 0, PACKET)


@pytest.mark.parametrize("kind", MESSAGES)
def test_packet_cut_anywhere_is_refused(kind: tuple[str, str, str]) -> None:
    """Protobuf may end behind any field: what is missing is empty."""
    encoding, msgtype, _ = kind
    whole = MESSAGES[kind]("h264")

    for size in range(len(whole)):
        try:
            frame = frame_view(topic(msgtype, encoding), memoryview(whole)[:size], 0)
        except FieldError as error:
            assert str(error).startswith("an image ")  # noqa: PT017
        else:
            assert encoding == "protobuf"
            assert frame.payload in {b"", PACKET}


@pytest.mark.parametrize(
    ("words", "codec"),
    [
        ("", "h264"),
        ("H264", "h264"),
        ("libx264;yuv420p;bgr8;rgb8", "h264"),
        ("h264_nvmpi", "h264"),
        ("hevc", "h265"),
        ("libx265", "h265"),
        ("libvpx-vp9", "vp9"),
        ("libsvtav1", "av1"),
        ("av1", "av1"),
        ("vp8", "vp8"),
        ("mjpeg", "mjpeg"),
        ("libx264;gray;bayer_rggb8;bayer_rggb8", "libx264;gray;bayer_rggb8;bayer_rggb8"),
    ],
)
def test_codecs_have_many_names(words: str, codec: str) -> None:
    """Encoders are named too; what is not read keeps its name."""
    assert video_encoding(words) == codec


@pytest.mark.parametrize(
    "payload", [b"\x1a\x05abc", b"\x0a\2\x0a\1", protobufs.payload(FOXGLOVE, 2**40 * 10**9)]
)
def test_protobuf_unlike_the_schema_is_refused(payload: bytes) -> None:
    """A length that does not fit, a time that no clock has."""
    with pytest.raises(FieldError, match=r"^an image that does not follow foxglove"):
        frame_view(topic(FOXGLOVE, "protobuf"), memoryview(payload), 0, "header")
