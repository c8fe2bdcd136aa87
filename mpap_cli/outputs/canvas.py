"""Drawing with OpenCV: colors that the color-blind can tell apart, text, one file."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]
Color = tuple[int, int, int]
Point = tuple[float, float]

INK: Color = (40, 40, 40)
PALE_INK: Color = (110, 110, 110)
GRID: Color = (222, 222, 222)
UNKNOWN: Color = (140, 140, 140)
# Blue, purple, vermilion as BGR: the ends stay apart for the color-blind, and no step
# between them looks like the grey of what is unknown.
_SCALE = np.array(((178, 114, 0), (163, 78, 123), (0, 94, 213)), dtype=np.float64)
_FONT = cv2.FONT_HERSHEY_SIMPLEX
_FRACTION_BITS = 4  # OpenCV draws between pixels when points are whole sixteenths


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle in pixels, from its upper left corner."""

    x: int
    y: int
    width: int
    height: int

    @property
    def right(self) -> int:
        """First column right of the box."""
        return self.x + self.width

    @property
    def bottom(self) -> int:
        """First row below the box."""
        return self.y + self.height


def probability_color(p: float) -> Color:
    """Return a color from blue (0) to vermilion (1); grey if p is NaN.

    >>> probability_color(float("nan"))
    (140, 140, 140)
    """
    if np.isnan(p):
        return UNKNOWN
    blue, green, red = (round(float(np.interp(p, (0, 0.5, 1), part))) for part in _SCALE.T)
    return blue, green, red


def pale(color: Color) -> Color:
    """Return a light tint of a color."""
    blue, green, red = (round(255 - 0.22 * (255 - part)) for part in color)
    return blue, green, red


def blank(width: int, height: int) -> Image:
    """Return a white picture."""
    return np.full((height, width, 3), 255, dtype=np.uint8)


def text_width(text: str, size: float, weight: int = 1) -> int:
    """Return how many pixels wide a text is."""
    return int(cv2.getTextSize(_drawable(text), _FONT, size, weight)[0][0])


def _drawable(text: str) -> str:
    """Return what OpenCV can write; a name that is no valid text would end the process."""
    return text.encode("ascii", "replace").decode()


def put_text(  # noqa: PLR0913  # a place, a text and its look
    image: Image,
    text: str,
    at: Point,
    *,
    size: float = 0.5,
    color: Color = INK,
    weight: int = 1,
    align: float = 0.0,
) -> None:
    """Write ASCII text; ``at`` is on its base line, ``align`` 0 left, .5 center, 1 right."""
    plain = _drawable(text)
    left = at[0] - align * text_width(plain, size, weight)
    place = (round(left), round(at[1]))
    cv2.putText(image, plain, place, _FONT, size, color, weight, cv2.LINE_AA)


def shorten(text: str, width: int, size: float) -> str:
    """Cut the middle out of a text until it is not wider than ``width`` pixels."""
    kept, short = len(text), text
    while kept > 1 and text_width(short, size) > width:
        kept -= 1
        short = f"{text[: kept - kept // 2]}...{text[len(text) - kept // 2 :]}"
    return short


def _sixteenths(points: NDArray[np.float64]) -> NDArray[np.int32]:
    """Return points as OpenCV takes them for drawing between pixels."""
    bounded = np.clip(points, -10_000, 10_000)
    return np.rint(bounded * (1 << _FRACTION_BITS)).astype(np.int32)


def draw_line(image: Image, points: NDArray[np.float64], color: Color, weight: int = 1) -> None:
    """Draw a line through points of shape (n, 2), in pixels."""
    curve = _sixteenths(points)
    cv2.polylines(image, [curve], False, color, weight, cv2.LINE_AA, _FRACTION_BITS)


def fill_polygon(image: Image, points: NDArray[np.float64], color: Color) -> None:
    """Fill the polygon with corners of shape (n, 2), in pixels."""
    cv2.fillPoly(image, [_sixteenths(points)], color, cv2.LINE_AA, _FRACTION_BITS)


def fill_box(image: Image, at: Point, size: tuple[float, float], color: Color) -> None:
    """Fill an upright rectangle from its upper left corner; size is width and height."""
    corners = np.array(((0, 0), (1, 0), (1, 1), (0, 1)), dtype=np.float64)
    fill_polygon(image, np.array(at) + corners * np.array(size), color)


def draw_dots(image: Image, points: NDArray[np.float64], color: Color, radius: float) -> None:
    """Draw a dot at each of the points of shape (n, 2), in pixels."""
    size = round(radius * (1 << _FRACTION_BITS))
    for x, y in _sixteenths(points).tolist():
        cv2.circle(image, (x, y), size, color, -1, cv2.LINE_AA, _FRACTION_BITS)


def draw_circle(image: Image, center: Point, radius: float, color: Color) -> None:
    """Draw a thin circle."""
    x, y = _sixteenths(np.array(center, dtype=np.float64)).tolist()
    size = round(radius * (1 << _FRACTION_BITS))
    cv2.circle(image, (x, y), size, color, 1, cv2.LINE_AA, _FRACTION_BITS)


def frame(image: Image, box: Box, color: Color = GRID) -> None:
    """Draw the border of a box."""
    last = (box.right - 1, box.bottom - 1)
    cv2.rectangle(image, (box.x, box.y), last, color, 1)


def paste(image: Image, picture: Image, box: Box) -> None:
    """Fit a picture into a box, its proportions kept, in the middle."""
    height, width = picture.shape[:2]
    scale = min(box.width / width, box.height / height)
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    way = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
    small = cv2.resize(picture, size, interpolation=way)
    x = box.x + (box.width - size[0]) // 2
    y = box.y + (box.height - size[1]) // 2
    image[y : y + size[1], x : x + size[0]] = small


def write_png(path: Path, image: Image, *, photographs: bool = False) -> None:
    """Write a picture; the same pixels, the same bytes.

    Parameters
    ----------
    path : Path
        File to write.
    image : Image
        What to write.
    photographs : bool
        Most of it is photographs: they pack best otherwise than drawings.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    # unfiltered rows pack best, and fastest, where a picture is drawn, not photographed
    way = cv2.IMWRITE_PNG_FILTER_PAETH if photographs else cv2.IMWRITE_PNG_FILTER_NONE
    options = [cv2.IMWRITE_PNG_FILTER, way, cv2.IMWRITE_PNG_COMPRESSION, 3]
    _, packed = cv2.imencode(".png", image, options)
    path.write_bytes(packed.tobytes())
