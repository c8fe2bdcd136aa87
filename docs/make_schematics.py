"""Write the schematics of the method to docs/pictures; ``--check`` fails if they differ."""

import sys
from pathlib import Path

from docs.affinity_pictures import messages, run_states
from docs.svg_picture import BLUE, GRAY, GREEN, HIGH, PALE, VERMILION, WIDE, Picture, Point

FOLDER = Path(__file__).parent / "pictures"

# Boxes of the pipeline stand in columns and rows.
COLUMN, ROW = 196, 132
LEFT, TOP = 20, 20


def place(column: int, row: int) -> Point:
    """Return the upper left corner of a box of the pipeline."""
    return LEFT + COLUMN * column, TOP + ROW * row


def side(column: int, row: int, where: str) -> Point:
    """Return the middle of a side of a box of the pipeline."""
    x, y = place(column, row)
    return {
        "left": (x, y + HIGH // 2),
        "right": (x + WIDE, y + HIGH // 2),
        "top": (x + WIDE // 2, y),
        "bottom": (x + WIDE // 2, y + HIGH),
    }[where]


def processes() -> Picture:
    """Draw what happens to an image, from the camera to the motion command (Fig. 5)."""
    words = "How images become clusters, obstacle probabilities, novelty and decisions"
    picture = Picture(2 * LEFT + 4 * COLUMN + WIDE, 2 * TOP + 2 * ROW + HIGH, words)
    boxes = (
        (2, 0, VERMILION, ("bumper, odometry", "touched? driven over?")),
        (3, 0, VERMILION, ("labels", "obstacle: pressed,", "free: driven floor")),
        (4, 0, VERMILION, ("counts per cluster", "p(obstacle), eq. (8)")),
        (0, 1, GRAY, ("camera image", "brought to 320 x 240")),
        (1, 1, GRAY, ("patches", "6 x 6, 53 x 40 pixels")),
        (2, 1, GRAY, ("features", "histograms of color", "(HSV), texture (LBP)")),
        (3, 1, BLUE, ("clusters", "long term: STRAP", "short term: AP")),
        (4, 1, BLUE, ("exemplars", "each with p(obstacle)", "of its cluster")),
        (1, 2, GREEN, ("novelty", "share of patches", "farther than eps")),
        (2, 2, GREEN, ("nearest exemplar", "of every patch", "of a new image")),
        (3, 2, GREEN, ("obstacle?", "p(obstacle) per patch,", "unknown ones marked")),
        (4, 2, GREEN, ("motion", "straight, rotate left,", "rotate right, stop")),
    )
    for column, row, color, lines in boxes:
        picture.box(place(column, row), color, lines)
    x, y = side(0, 0, "left")
    picture.text((x, y), "what it touches", bold=True, color=VERMILION, size=16)
    picture.text((x, y + 22), "labels are counted, they never move a cluster", color=PALE)
    x, y = side(0, 2, "left")
    picture.text((x, y), "what it is good for", bold=True, color=GREEN, size=16)
    for row, first in ((0, 2), (1, 0), (2, 2)):
        for column in range(first, 4):
            picture.arrow(side(column, row, "right"), side(column + 1, row, "left"))
    picture.arrow(side(4, 0, "bottom"), side(4, 1, "top"))
    picture.arrow(side(2, 1, "bottom"), side(2, 2, "top"))
    picture.arrow(side(2, 2, "left"), side(1, 2, "right"))
    x, y = side(4, 1, "bottom")
    into = side(2, 2, "top")[0] + 50
    picture.arrow((x, y), (x, y + 20), (into, y + 20), (into, side(2, 2, "top")[1]))
    return picture


def meta_points() -> Picture:
    """Draw the three cases of a new point (Fig. 4, Algorithm 1)."""
    words = "The three cases of a new point in meta-point affinity propagation"
    picture = Picture(980, 330, words)
    radius = 62
    clusters = ((120, 130), (262, 84))
    noise, fresh = (300, 232), (452, 112)
    for center in clusters:
        picture.circle(center, radius, BLUE)
    picture.dots(BLUE, (120, 130), (98, 112), (138, 106), (110, 158), (152, 150), (86, 142))
    picture.dots(BLUE, (262, 84), (240, 66), (284, 60), (272, 112), (238, 104))
    picture.circle(noise, radius, GRAY, dashed=True)
    picture.dots(GRAY, noise, (280, 252), (326, 214))
    picture.circle(fresh, radius, VERMILION, dashed=True)
    for name, at in (("A", (124, 178)), ("B", (322, 254)), ("C", fresh)):
        picture.dots(VERMILION, at)
        picture.text((at[0] + 8, at[1] + 5), name, bold=True, color=VERMILION, size=17)
    picture.text((120, 58), "cluster-points", align="middle", color=BLUE)
    picture.text((300, 314), "noise-point", align="middle", color=GRAY)
    picture.text((452, 40), "new noise-point", align="middle", color=VERMILION)
    x = 560
    cases = (
        ("A  joins the nearest cluster-point", "if its mean is nearer than theta (lines 1-3)"),
        (
            "B  joins the nearest noise-point",
            "else, if that is near; with min-points points",
            "it becomes a cluster-point (lines 5-10)",
        ),
        ("C  becomes a noise-point", "if nothing is near (lines 11-13)"),
    )
    y = 56
    for lines in cases:
        for index, line in enumerate(lines):
            offset = 24 if index else 0
            picture.text((x + offset, y), line, bold=not index, size=15 if not index else 13)
            y += 22
        y += 14
    picture.text((x, y + 6), "Circles have the radius theta. Affinity propagation", color=PALE)
    picture.text((x, y + 26), "then clusters the cluster-points only.", color=PALE)
    return picture


def main() -> int:
    """Write or check the pictures."""
    pictures = {
        "messages.svg": messages().svg(),
        "affinity-run.svg": run_states().svg(),
        "processes.svg": processes().svg(),
        "meta-points.svg": meta_points().svg(),
    }
    stale = [
        name
        for name, text in pictures.items()
        if not (FOLDER / name).is_file() or (FOLDER / name).read_text(encoding="utf-8") != text
    ]
    if "--check" in sys.argv:
        if stale:
            sys.stderr.write(f"docs/pictures: {', '.join(stale)} out of date; run 'make docs'\n")
        return int(bool(stale))
    FOLDER.mkdir(exist_ok=True)
    for name in stale:
        (FOLDER / name).write_text(pictures[name], encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
