"""Images and video out of one topic."""

import sys

import pytest

from mpap_cli.features.images.frame_decoder import FrameDecoder
from mpap_cli.observations import Frame


def test_images_need_no_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without PyAV all that is no video is decoded, also where there is nothing to decode."""
    monkeypatch.setitem(sys.modules, "av", None)
    monkeypatch.setitem(sys.modules, "av.error", None)
    decoder = FrameDecoder()

    found = list(decoder.decode([Frame(0, "mono8", 1, 1, 1, bytes([7]))]))

    assert [(position, type(one).__name__) for position, one in found] == [(0, "Decoded")]
    assert list(decoder.decode([])) == []
