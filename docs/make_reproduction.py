"""Make docs/reproduction.md of what ``mpap reproduce -o OUT`` wrote.

python docs/make_reproduction.py OUT      takes report and figures, at most 1,000 pixels wide
"""

import re
import sys
from pathlib import Path

import cv2

from mpap_cli.outputs.results_reader import read_results

FOLDER = Path(__file__).parent
PICTURES = FOLDER / "pictures" / "reproduction"
WIDEST = 1000

_PICTURE = re.compile(r"\]\((figure-[\w-]+\.png)\)")


def make_page(out: Path) -> tuple[str, list[str]]:
    """Return the page and the names of its figures; figures lie in a folder of their own."""
    results = read_results(out / "reproduce")
    text = results.path("reproduced.md").read_text(encoding="utf-8")
    names = _PICTURE.findall(text)
    for name in names:
        _shrink(results.path(name), PICTURES / name)
    folder = PICTURES.relative_to(FOLDER).as_posix()
    return _PICTURE.sub(rf"]({folder}/\1)", text), names


def _shrink(source: Path, target: Path) -> None:
    """Write a figure as small as a page needs it."""
    image = cv2.imread(str(source))
    if image is None:
        msg = f"{source}: no picture"
        raise ValueError(msg)
    height, width = image.shape[:2]
    scale = min(1.0, WIDEST / width)
    size = (round(width * scale), round(height * scale))
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    target.parent.mkdir(exist_ok=True)
    cv2.imwrite(str(target), small, [cv2.IMWRITE_PNG_COMPRESSION, 9])


def main() -> int:
    """Write the page, and remove figures that are no longer in it."""
    page, names = make_page(Path(sys.argv[1]))
    for stale in PICTURES.glob("*.png"):
        if stale.name not in names:
            stale.unlink()
    (FOLDER / "reproduction.md").write_text(page, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
