"""The schematics of the documents."""

import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

DOCS = Path(__file__).parent.parent / "docs"
NAMES = ("processes.svg", "meta-points.svg", "messages.svg", "affinity-run.svg")
SVG = "{http://www.w3.org/2000/svg}"


def test_schematics_are_those_that_the_script_draws() -> None:
    """Whoever changes the script draws them anew."""
    done = subprocess.run(  # noqa: S603  # our own script
        [sys.executable, DOCS / "make_schematics.py", "--check"],
        check=False,
        capture_output=True,
        text=True,
    )

    assert (done.returncode, done.stderr) == (0, "")


def width_of(text: ET.Element) -> float:
    """Return how wide a text is in DejaVu Sans, which is wider than most other fonts."""
    font = FontProperties(family="DejaVu Sans", weight=text.attrib.get("font-weight", "normal"))
    place = TextPath((0, 0), text.text or "", size=int(text.attrib["font-size"]), prop=font)
    return float(place.get_extents().width)


@pytest.mark.parametrize("name", NAMES)
def test_everything_lies_on_the_paper(name: str) -> None:
    """No shape and no text reaches beyond the picture, and there is a title to read out."""
    root = ET.parse(DOCS / "pictures" / name).getroot()  # noqa: S314  # our own file
    width, height = (int(word) for word in root.attrib["viewBox"].split()[2:])

    for text in root.iter(f"{SVG}text"):
        length = width_of(text)
        left = int(text.attrib["x"]) - (length / 2 if text.attrib["text-anchor"] == "middle" else 0)
        assert 0 <= left <= left + length <= width
        assert 0 < int(text.attrib["y"]) < height
    for line in root.iter(f"{SVG}polyline"):
        for point in line.attrib["points"].split():
            x, y = (int(number) for number in point.split(","))
            assert 0 <= x <= width
            assert 0 <= y <= height
    assert root.findtext(f"{SVG}title")


def test_texts_fit_their_boxes() -> None:
    """Every line of a box of the pipeline ends within it."""
    root = ET.parse(DOCS / "pictures" / NAMES[0]).getroot()  # noqa: S314  # our own file
    boxes = [box.attrib for box in root.iter(f"{SVG}rect") if "rx" in box.attrib]

    for text in root.iter(f"{SVG}text"):
        if text.attrib["text-anchor"] != "middle":
            continue
        x, y = int(text.attrib["x"]), int(text.attrib["y"])
        inside = [
            box
            for box in boxes
            if int(box["x"]) < x < int(box["x"]) + int(box["width"])
            and int(box["y"]) < y < int(box["y"]) + int(box["height"])
        ]
        assert len(inside) == 1
        assert width_of(text) < int(inside[0]["width"])
