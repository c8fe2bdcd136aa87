"""Video becomes embedded patches, as images of its own would."""

from dataclasses import replace

import numpy as np
import pytest

from mpap_cli.features.images.frame_decoder import FrameDecoder
from mpap_cli.features.images.patch_features import SIZE_CHANGES, PatchEmbedder
from mpap_cli.features.images.video_decode import BEFORE_KEYFRAME, DAMAGED, Picture
from mpap_cli.logs.video.links import PacketLinks
from mpap_cli.observations import Frame
from mpap_cli.params import ImageParams
from tests.videos import (
    CODECS,
    KEY_EVERY,
    N_PICTURES,
    encode_video,
    linked,
    packets_of,
    pictures,
    ride,
)

SMALL = ImageParams(grid="2x3", image_size="48x32")


def raw(picture: Picture) -> Frame:
    """Return a picture as an image of encoding bgr8."""
    height, width = picture.shape[:2]
    return Frame(0, "bgr8", width, height, 3 * width, picture.tobytes())


@pytest.mark.parametrize("codec", CODECS)
def test_features_are_those_of_the_pictures(codec: str) -> None:
    """A video and its pictures as images of their own give the same patches."""
    frames = linked(codec, packets_of(codec))

    block = PatchEmbedder(SMALL).transform(frames)
    of_pictures = PatchEmbedder(SMALL).transform([raw(one) for one in pictures(frames)])

    np.testing.assert_array_equal(block.features, of_pictures.features)
    assert block.stamps_ns.tolist() == block.kept.tolist() == list(range(N_PICTURES))


def test_images_left_out_of_a_video_are_counted() -> None:
    """The rest is used in its order, also where B-frames come out of theirs."""
    frames = linked("h264", packets_of("h264", 3)[2:])
    frames[-1] = replace(frames[-1], payload=b"")
    embedder = PatchEmbedder(SMALL)

    block = embedder.transform(frames)

    assert embedder.skipped == {BEFORE_KEYFRAME: KEY_EVERY - 2, DAMAGED: 1}
    assert block.kept.tolist() == list(range(KEY_EVERY - 2, N_PICTURES - 3))
    assert block.stamps_ns.tolist() == block.kept.tolist()


def test_a_change_of_size_within_a_video_is_counted() -> None:
    """Pictures of both sizes are used."""
    links = PacketLinks()
    larger = [packet for packet, _ in encode_video("h264", ride(9, 128, 96))]
    frames = linked("h264", packets_of("h264"), links) + linked("h264", larger, links)
    embedder = PatchEmbedder(SMALL)

    block = embedder.transform(frames)

    assert len(block.kept) == N_PICTURES + 9
    assert (embedder.changes, +embedder.skipped) == ({SIZE_CHANGES: 1}, {})


def test_stills_and_video_may_come_together() -> None:
    """Each image is found by its place among the frames."""
    video = linked("h264", packets_of("h264"))
    still = raw(np.full((2, 3, 3), 9, np.uint8))

    found = dict(FrameDecoder().decode([video[0], still, video[1], Frame(0, "vp8", 0, 0, 0, b"")]))

    sizes = [found[number] for number in range(4)]
    assert [one if isinstance(one, str) else one.size for one in sizes] == [
        (96, 64),
        (3, 2),
        (96, 64),
        "encoding vp8",
    ]
