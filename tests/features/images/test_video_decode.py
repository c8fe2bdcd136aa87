"""Packets of video become the pictures that were recorded, in whichever way they are asked for."""

import pickle
import sys

import numpy as np
import pytest

from mpap_cli.errors import UsageError
from mpap_cli.features.images import video_decode as decode_module
from mpap_cli.features.images.image_decode import decode_frame
from mpap_cli.features.images.video_decode import DAMAGED, NO_PICTURE, VideoDecoder
from mpap_cli.logs.video import links as links_module
from mpap_cli.logs.video.links import PacketLinks
from mpap_cli.observations import Frame
from tests.videos import (
    CODECS,
    N_PICTURES,
    decoded,
    encode_video,
    linked,
    packets_of,
    pictures,
    ride,
)

SHUFFLED = [("h264", 3), *((codec, 0) for codec in CODECS)]


@pytest.mark.parametrize("codec", CODECS)
def test_every_packet_gives_its_picture(codec: str) -> None:
    """What comes out is what was recorded, but for the loss of the codec."""
    found = pictures(linked(codec, packets_of(codec)))

    assert len(found) == N_PICTURES
    for was, now in zip(ride(N_PICTURES, 96, 64), found, strict=True):
        assert (now.shape, now.dtype) == (was.shape, was.dtype)
        assert np.abs(was.astype(int) - now).mean() < 14


def test_a_picture_goes_to_its_packet_in_whichever_order_they_come() -> None:
    """B-frames are recorded behind pictures that are shown later."""
    shown = ride(N_PICTURES, 96, 64)
    packets = encode_video("h264", shown, b_frames=3)
    numbers = [number for _, number in packets]

    found = pictures(linked("h264", [packet for packet, _ in packets]))

    assert numbers != sorted(numbers)
    for number, picture in zip(numbers, found, strict=True):
        distance = [np.abs(one.astype(int) - picture).mean() for one in shown]
        assert int(np.argmin(distance)) == number


@pytest.mark.parametrize(("codec", "b_frames"), SHUFFLED)
def test_pictures_do_not_depend_on_what_comes_together(codec: str, b_frames: int) -> None:
    """In pieces, one by one, some only, and out of order they are those of a whole video."""
    frames = linked(codec, packets_of(codec, b_frames))
    whole = pictures(frames)

    decoder = VideoDecoder()
    pieces = [pictures(frames[i:j], decoder) for i, j in ((0, 5), (5, 6), (6, 13), (13, None))]
    alone = [decode_frame(frame) for frame in frames]
    some = pictures([frames[number] for number in (3, 4, 18)])
    swapped = decoded([frames[number] for number in (1, 0, 3, 2, 12, 5)])

    np.testing.assert_array_equal(np.concatenate(pieces), whole)
    np.testing.assert_array_equal(np.stack([one for one in alone if one is not None]), whole)
    for number, picture in zip((3, 4, 18), some, strict=True):
        np.testing.assert_array_equal(picture, whole[number])
    for number, found in zip((1, 0, 3, 2, 12, 5), swapped, strict=True):
        assert isinstance(found, np.ndarray)
        np.testing.assert_array_equal(found, whole[number])


def test_a_line_that_is_cut_is_decoded_in_its_course(monkeypatch: pytest.MonkeyPatch) -> None:
    """A video of one keyframe holds on to so many packets and no more."""
    monkeypatch.setattr(links_module, "MOST_LINKED", 5)
    packets = [packet for packet, _ in encode_video("h264", ride(14, 96, 64), key_every=99)]
    frames = linked("h264", packets)

    decoder = VideoDecoder()
    found = [pictures(frames[:7], decoder), pictures(frames[7:], decoder)]
    alone = [decode_frame(frame) is not None for frame in frames]

    assert [len(part) for part in found] == [7, 7]
    assert alone == [True] * 5 + [False] * 9


def test_a_video_of_one_keyframe_goes_on_with_b_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures that come too late for a call are lost rather than all that follow the cut."""
    monkeypatch.setattr(links_module, "MOST_LINKED", 30)
    monkeypatch.setattr(decode_module, "_LONG_LINE", 15)
    shown = ride(60, 96, 64)
    packets = [packet for packet, _ in encode_video("h264", shown, key_every=99, b_frames=3)]
    frames, decoder = linked("h264", packets), VideoDecoder()

    found = [decoded(frames[first : first + 10], decoder) for first in range(0, 60, 10)]

    late = [sum(isinstance(one, str) for one in part) for part in found]
    assert late[0] == 0
    assert sum(late) < 15
    assert {one for part in found for one in part if isinstance(one, str)} == {NO_PICTURE}


def test_what_opens_a_video_needs_no_place() -> None:
    """A keyframe can be decoded as it is, what follows it cannot."""
    first, second, *_ = (Frame(0, "h264", 0, 0, 0, packet) for packet in packets_of("h264"))

    found = decoded([second, first])

    assert found[0] == DAMAGED
    assert isinstance(found[1], np.ndarray)
    assert decode_frame(second) is None


def test_codecs_may_change_within_a_video() -> None:
    """The decoder changes with them."""
    links = PacketLinks()
    frames = [
        frame
        for codec in ("h264", "vp9", "h264")
        for frame in linked(codec, packets_of(codec), links)
    ]

    found = pictures(frames)

    assert len(found) == 3 * N_PICTURES
    np.testing.assert_array_equal(found[:N_PICTURES], found[2 * N_PICTURES :])


def test_a_copy_of_a_decoder_goes_on() -> None:
    """It begins anew with the packets that the next frame holds on to."""
    frames = linked("h264", packets_of("h264"))
    decoder = VideoDecoder()
    pictures(frames[:5], decoder)

    copy = pickle.loads(pickle.dumps(decoder))  # noqa: S301  # our own bytes

    np.testing.assert_array_equal(pictures(frames[5:], copy), pictures(frames[5:], decoder))


def test_without_the_extra_video_is_a_usage_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """The error says what to install; so it does where PyAV lacks the decoder."""
    monkeypatch.setitem(decode_module._DECODERS, "vp9", "no such decoder")
    with pytest.raises(UsageError, match=r'^vp9 video: .*; pip install "mpap\[video\]"$'):
        decode_frame(linked("vp9", packets_of("vp9"))[0])

    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(UsageError, match=r'^h264 video: .*; pip install "mpap\[video\]"$'):
        decode_frame(linked("h264", packets_of("h264"))[0])
