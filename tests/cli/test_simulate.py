"""The options of the camera of a simulated robot."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mpap_cli.cli.simulate import ENCODINGS, LIGHTS, TEXTURES
from mpap_cli.simulation import camera_messages, lights, palettes


def test_choices_are_those_of_the_code() -> None:
    """What is copied so that help starts fast does not fall behind."""
    assert camera_messages.ENCODINGS == ENCODINGS
    assert tuple(palettes.PALETTES) == TEXTURES
    assert tuple(lights.LIGHTS) == LIGHTS


def test_camera_has_its_options(run: Callable[..., Any], tmp_path: Path) -> None:
    """Rate, size, encoding, surfaces and light are taken; the images are counted."""
    words = "--camera --camera-hz 2 --image-size 64x64 --image-encoding png --textures c"

    outcome = run(
        "simulate", tmp_path / "a.mcap", *words.split(), "--light", "evening", "--duration", 3
    )

    assert outcome.code == 0
    assert "30 scans, 6 images, " in outcome.out
    assert (tmp_path / "a.mcap.patches.csv").exists()


@pytest.mark.parametrize(
    "words", ["--camera-hz 2", "--image-size 64x64", "--textures b", "--light day --no-camera"]
)
def test_options_of_the_camera_need_it(run: Callable[..., Any], tmp_path: Path, words: str) -> None:
    """Without a camera its options are a mistake, and nothing is written."""
    outcome = run("simulate", tmp_path / "a.mcap", *words.split())

    assert outcome.code == 2
    assert f"{words.split(maxsplit=1)[0]} needs --camera" in outcome.err
    assert list(tmp_path.iterdir()) == []
