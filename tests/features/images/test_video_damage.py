"""What is broken in a video costs the pictures that build on it, and no more."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.features.images.video_decode import AFTER_DAMAGE, BEFORE_KEYFRAME, DAMAGED
from mpap_cli.logs.video.links import PacketLinks
from tests.videos import CODECS, KEY_EVERY, N_PICTURES, decoded, linked, packets_of, pictures


@pytest.mark.parametrize("codec", CODECS)
def test_packets_before_the_first_keyframe_have_no_picture(codec: str) -> None:
    """They are told from damaged ones; from the keyframe on nothing is missing."""
    whole = pictures(linked(codec, packets_of(codec)))

    found = decoded(linked(codec, packets_of(codec)[3:]))

    assert found[: KEY_EVERY - 3] == [BEFORE_KEYFRAME] * (KEY_EVERY - 3)
    for was, now in zip(whole[KEY_EVERY:], found[KEY_EVERY - 3 :], strict=True):
        assert isinstance(now, np.ndarray)
        np.testing.assert_array_equal(now, was)


@pytest.mark.parametrize("damage", ["cut", "junk", "empty"])
@pytest.mark.parametrize("codec", CODECS)
def test_damage_costs_the_pictures_up_to_the_next_keyframe(codec: str, damage: str) -> None:
    """None of them would be whole; those before and behind are as ever."""
    packets = list(packets_of(codec))
    whole = pictures(linked(codec, packets))
    packets[3] = {"cut": packets[3][:12], "junk": bytes(60), "empty": b""}[damage]

    found = decoded(linked(codec, packets))

    assert found[3:KEY_EVERY] == [DAMAGED, *[AFTER_DAMAGE] * (KEY_EVERY - 4)]
    for number in (*range(3), *range(KEY_EVERY, N_PICTURES)):
        np.testing.assert_array_equal(found[number], whole[number])


def test_damage_leaves_pictures_alone_that_are_still_on_their_way() -> None:
    """With B-frames two of them come out behind the damaged packet."""
    packets = list(packets_of("h264", 3))
    whole = pictures(linked("h264", packets))
    packets[3] = b"\1" * 60

    found = decoded(linked("h264", packets))

    for number in (0, 1, 2, *range(KEY_EVERY, N_PICTURES)):
        np.testing.assert_array_equal(found[number], whole[number])
    assert found[3] == DAMAGED


def test_a_message_that_is_lost_spoils_what_builds_on_it() -> None:
    """The number of the next packet tells that there is a gap."""
    links = PacketLinks()
    before = linked("h264", packets_of("h264")[:3], links)
    links.skip()

    found = decoded([*before, *linked("h264", packets_of("h264")[4:], links)])

    assert Counter(one for one in found if isinstance(one, str)) == {AFTER_DAMAGE: KEY_EVERY - 4}


def test_a_size_that_no_camera_has_is_refused() -> None:
    """VP9 states width and height in 16 bits each, behind 4 bytes and 4 bits."""
    packet = packets_of("vp9")[0]
    bits = int.from_bytes(packet[4:9], "big")
    huge = packet[:4] + (bits | (2**32 - 1) << 4).to_bytes(5, "big") + packet[9:]

    found = decoded(linked("vp9", [huge, packet]))

    assert found[0] == DAMAGED
    assert isinstance(found[1], np.ndarray)


@given(
    codec=st.sampled_from(CODECS),
    number=st.integers(0, N_PICTURES - 1),
    place=st.integers(0, 200),
    noise=st.binary(max_size=9),
)
def test_broken_packets_never_raise(codec: str, number: int, place: int, noise: bytes) -> None:
    """Each frame has a picture or a reason; what lies before the damage is untouched."""
    packets = list(packets_of(codec))
    packet = packets[number]
    packets[number] = packet[:place] + noise + packet[place + len(noise) :]

    found = decoded(linked(codec, packets))

    assert all(isinstance(one, np.ndarray) for one in found[:number])
