"""Packets with which decoding can begin are told from those that build on others."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs.video.openings import opens_video
from tests.videos import CODECS, KEY_EVERY, N_PICTURES, packets_of

START = b"\0\0\0\1"
H264_PARAMETERS, H264_IDR, H264_SLICE = b"\x67abc", b"\x65abc", b"\x41abc"
H265_PARAMETERS, H265_CRA, H265_SLICE = b"\x42\1abc", b"\x2a\1abc", b"\2\1abc"


def units(*parts: bytes) -> bytes:
    """Return NAL units behind start codes."""
    return b"".join(START + part for part in parts)


@pytest.mark.parametrize("codec", CODECS)
def test_keyframes_of_an_encoder_open_a_video(codec: str) -> None:
    """And nothing else of it does."""
    packets = packets_of(codec)

    found = [number for number, packet in enumerate(packets) if opens_video(codec, packet)]

    assert found == list(range(0, N_PICTURES, KEY_EVERY))


@pytest.mark.parametrize(
    ("codec", "packet", "opens"),
    [
        ("h264", units(b"\x09\x10", H264_PARAMETERS, b"\x68ab", H264_IDR), True),
        ("h264", units(H264_PARAMETERS, H264_IDR)[1:], True),
        ("h264", units(H264_IDR), False),
        ("h264", units(H264_PARAMETERS, H264_SLICE, H264_IDR), False),
        ("h264", units(H264_PARAMETERS), True),
        ("h264", START, False),
        ("h265", units(b"\x40\1ab", H265_PARAMETERS, H265_CRA), True),
        ("h265", units(H265_CRA), False),
        ("h265", units(H265_PARAMETERS, H265_SLICE), False),
        ("h265", units(H265_PARAMETERS), True),
        ("vp9", b"", False),
        ("vp9", bytes([0b01000010]), False),
        ("vp9", bytes([0b10001000]), False),
        ("vp9", bytes([0b10110001]), True),
        ("vp9", bytes([0b10110100]), False),
        ("vp9", bytes([0b10110010]), False),
        ("av1", b"", False),
        ("av1", bytes([0b00010010, 0, 0b00001010, 1, 7, 0b00110010, 1, 0b00010000]), True),
        ("av1", bytes([0b00001010, 1, 7, 0b00110010, 1, 0b00110000]), False),
        ("av1", bytes([0b00001010, 1, 7, 0b00110010, 1, 0b10000000]), False),
        ("av1", bytes([0b00110010, 1, 0b00010000]), False),
        ("av1", bytes([0b00001110, 8, 0x81, 0, 7, 0b00110000, 0b00010000]), True),
        ("av1", bytes([0b00001000, 7]), True),
    ],
)
def test_parameters_and_a_picture_of_its_own_open_a_video(
    codec: str, packet: bytes, *, opens: bool
) -> None:
    """Parameters alone do too; what comes behind the first picture does not count."""
    assert opens_video(codec, packet) is opens


@given(codec=st.sampled_from(CODECS), packet=st.binary(max_size=40))
def test_any_bytes_open_a_video_or_do_not(codec: str, packet: bytes) -> None:
    """What is no video is no error here."""
    assert opens_video(codec, packet) in {True, False}
