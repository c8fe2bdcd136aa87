"""Compiled loops over the rows of an image: bins of color and codes of neighborhoods.

A row passes through several short loops over arrays of one type each, which become vector
instructions; one loop over everything would not.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

U8 = NDArray[np.uint8]
U16 = NDArray[np.uint16]
I16 = NDArray[np.int16]

# Diagonal neighbors on the circle of radius 1, rounded as scikit-image rounds them.
DIAGONAL = 0.70711

_HALF_12 = np.int32(1 << 11)
_HALF_15 = np.int32(1 << 14)
_HALF = np.float32(0.5)
# Numerators of OpenCV's tables of division: 255 and 180 / 6 in fixed point of 12 bits.
_SATURATION = np.float32(255 << 12)
_HUE = np.float32(30 << 12)
_HUES = np.int16(180)
# x * 5826 >> 16 is x * 16 // 180 for every hue x.
_HUE_BIN = np.uint32(5826)


@njit(nogil=True, cache=True, error_model="numpy")
def _split_row(row: U8, blue: U8, green: U8, red: U8) -> None:
    """Part the channels of one row of pixels."""
    for x in range(blue.size):
        blue[x] = row[3 * x]
        green[x] = row[3 * x + 1]
        red[x] = row[3 * x + 2]


@njit(nogil=True, cache=True, error_model="numpy")
def _gray_row(blue: U8, green: U8, red: U8, gray: U8) -> None:
    """Write the gray of one row, as OpenCV computes it in fixed point of 15 bits."""
    for x in range(blue.size):
        total = np.int32(blue[x]) * np.int32(3735)
        total += np.int32(green[x]) * np.int32(19235)
        total += np.int32(red[x]) * np.int32(9798)
        gray[x] = np.uint8((total + _HALF_15) >> np.int32(15))


@njit(nogil=True, cache=True, error_model="numpy")
def _value_row(blue: U8, green: U8, red: U8, value: U8, span: U8) -> None:
    """Write the value of one row, and the span from the least channel to the greatest."""
    for x in range(blue.size):
        b, g, r = blue[x], green[x], red[x]
        high = b if b > g else g  # noqa: FURB136  # numba widens max() to 64 bits
        high = high if high > r else r  # noqa: FURB136
        low = b if b < g else g  # noqa: FURB136
        low = low if low < r else r  # noqa: FURB136
        value[x] = high
        span[x] = np.uint8(high - low)


@njit(nogil=True, cache=True, error_model="numpy")
def _angle_row(blue: U8, green: U8, red: U8, value: U8, span: U8, angle: I16) -> None:
    """Write the numerator of the hue of one row, from -span to 5 span."""
    for x in range(blue.size):
        b, g, r, s = np.int16(blue[x]), np.int16(green[x]), np.int16(red[x]), np.int16(span[x])
        from_red = np.int16(g - b)
        from_green = np.int16(b - r + s + s)
        from_blue = np.int16(r - g + s + s + s + s)
        other = from_green if green[x] == value[x] else from_blue
        angle[x] = from_red if red[x] == value[x] else other


@njit(nogil=True, cache=True, error_model="numpy")
def _quotient_row(value: U8, span: U8, angle: I16, saturation: U8) -> None:
    """Turn the angles of one row into hues, and write the bins of the saturation.

    OpenCV takes both factors from tables. Here they come from one division in float32,
    which gives the table's integers for every value and every span.
    """
    for x in range(value.size):
        v, s = np.int32(value[x]), np.int32(span[x])
        high, wide = np.float32(max(v, np.int32(1))), np.float32(max(s, np.int32(1)))
        inverse = np.float32(1.0) / (high * wide)
        by_value = np.int32(wide * (inverse * _SATURATION) + _HALF)
        by_span = np.int32(high * (inverse * _HUE) + _HALF)
        angle[x] = np.int16((np.int32(angle[x]) * by_span + _HALF_12) >> np.int32(12))
        saturation[x] = np.uint8((s * by_value + _HALF_12) >> np.int32(16))


@njit(nogil=True, cache=True, error_model="numpy")
def _index_row(value: U8, hue: I16, saturation: U8, index: U16) -> None:
    """Join the bins of one row; hues below 0 go round."""
    for x in range(value.size):
        turned = np.int16(hue[x] + _HUES) if hue[x] < np.int16(0) else hue[x]
        hue_bin = np.uint16((np.uint32(np.uint16(turned)) * _HUE_BIN) >> np.uint32(16))
        value_bin = np.uint16(value[x] >> np.uint8(4))
        index[x] = np.uint16(
            (value_bin << np.uint16(8)) | (hue_bin << np.uint16(4)) | np.uint16(saturation[x])
        )


@njit(nogil=True, cache=True, error_model="numpy")
def _square_row(above: U8, here: U8, below: U8, codes: U8) -> None:
    """Write the codes of one row but its ends: neighbors of the square that are not darker.

    Bits run against the clock from the neighbor to the right.
    """
    n = here.size - 2
    a0, a1, a2 = above[:n], above[1 : n + 1], above[2:]
    b0, b1, b2 = here[:n], here[1 : n + 1], here[2:]
    c0, c1, c2 = below[:n], below[1 : n + 1], below[2:]
    none = np.uint8(0)
    for x in range(n):
        center = b1[x]
        code = np.uint8(1) if b2[x] >= center else none
        code |= np.uint8(2) if a2[x] >= center else none
        code |= np.uint8(4) if a1[x] >= center else none
        code |= np.uint8(8) if a0[x] >= center else none
        code |= np.uint8(16) if b0[x] >= center else none
        code |= np.uint8(32) if c0[x] >= center else none
        code |= np.uint8(64) if c1[x] >= center else none
        code |= np.uint8(128) if c2[x] >= center else none
        codes[x + 1] = code


@njit(nogil=True, cache=True, error_model="numpy")
def _between(first: float, second: float, share: float) -> float:
    """Interpolate, in the order of operations of scikit-image."""
    return (1 - share) * first + share * second


@njit(nogil=True, cache=True, error_model="numpy")
def _circular_row(above: U8, here: U8, below: U8, y: int, codes: U8) -> None:
    """Write the codes of row ``y`` but its ends: neighbors on the circle of radius 1.

    The diagonal ones are interpolated in float64 at absolute positions, as scikit-image
    does it: that decides where a neighbor is exactly as bright as the pixel.
    """
    up = (y - DIAGONAL) - (y - 1)
    down = (y + DIAGONAL) - y
    for x in range(1, here.size - 1):
        center = np.float64(here[x])
        left = (x - DIAGONAL) - (x - 1)
        right = (x + DIAGONAL) - x
        a0 = _between(above[x - 1], above[x], left)
        a2 = _between(above[x], above[x + 1], right)
        b0 = _between(here[x - 1], here[x], left)
        b2 = _between(here[x], here[x + 1], right)
        c0 = _between(below[x - 1], below[x], left)
        c2 = _between(below[x], below[x + 1], right)
        code = 1 if here[x + 1] >= here[x] else 0
        code |= 2 if _between(a2, b2, up) >= center else 0
        code |= 4 if above[x] >= here[x] else 0
        code |= 8 if _between(a0, b0, up) >= center else 0
        code |= 16 if here[x - 1] >= here[x] else 0
        code |= 32 if _between(b0, c0, down) >= center else 0
        code |= 64 if below[x] >= here[x] else 0
        code |= 128 if _between(b2, c2, down) >= center else 0
        codes[x] = np.uint8(code)


@njit(nogil=True, cache=True, error_model="numpy")
def _describe_image(image: U8, circular: bool, index: U16, codes: U8) -> None:
    """Write index and code of every pixel; codes at the border of the image are 0."""
    n_rows, n_columns = index.shape
    blue, green = np.empty(n_columns, np.uint8), np.empty(n_columns, np.uint8)
    red, value = np.empty(n_columns, np.uint8), np.empty(n_columns, np.uint8)
    span, saturation = np.empty(n_columns, np.uint8), np.empty(n_columns, np.uint8)
    angle = np.empty(n_columns, np.int16)
    gray = np.empty((3, n_columns), np.uint8)
    for y in range(n_rows):
        _split_row(image[y], blue, green, red)
        _gray_row(blue, green, red, gray[y % 3])
        _value_row(blue, green, red, value, span)
        _angle_row(blue, green, red, value, span, angle)
        _quotient_row(value, span, angle, saturation)
        _index_row(value, angle, saturation, index[y])
        codes[y, 0] = codes[y, n_columns - 1] = 0
        if y >= 2:  # noqa: PLR2004  # the row before now has both of its neighbors
            above, here, below = gray[(y - 2) % 3], gray[(y - 1) % 3], gray[y % 3]
            if circular:
                _circular_row(above, here, below, y - 1, codes[y - 1])
            else:
                _square_row(above, here, below, codes[y - 1])
    codes[0] = codes[n_rows - 1] = 0


def describe_pixels(image: U8, index: U16, codes: U8, *, circular: bool) -> None:
    """Write the index of the color and the code of the neighborhood of every pixel.

    ``image`` (H, W, 3) is BGR, contiguous; ``index`` and ``codes`` are (H, W). An index is
    value * 256 + hue * 16 + saturation, each the bin (of 16) of OpenCV's 8-bit HSV. Bits of
    a code run against the clock from the neighbor to the right, 1 where it is not darker;
    pixels at the border have code 0.
    """
    _describe_image(image.reshape(len(image), -1), circular, index, codes)
