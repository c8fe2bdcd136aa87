"""Settings of the features of camera images (section 4.2.2)."""

from dataclasses import dataclass

from mpap_cli.params.checks import check_choices, require, setting

_MOST_PIXELS = 4096
_LEAST_PATCH = 8
_MOST_PATCHES = 144


@dataclass(frozen=True, slots=True, kw_only=True)
class ImageParams:
    """How an image is cut into patches, and what describes a patch (section 4.2.2)."""

    grid: str = setting("6x6", "4.2.2", "rows x columns of patches")
    image_size: str = setting("320x240", "5.3", "width x height that images are brought to")
    image_decode: str = setting(
        "scaled",
        "ours",
        "JPEG is decoded at the smallest scale that gives image-size, or in full",
        ("scaled", "full"),
    )
    lbp: str = setting(
        "square", "4.2.2", "neighbors of a pixel: of the 3x3 square, or on a circle",
        ("square", "circular"),
    )  # fmt: skip
    color_weight: float = setting(0.5, "4.2.2", "weight of color; texture has the rest")

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        check_choices(self)
        require(0 <= self.color_weight <= 1, "color-weight", self.color_weight, "0 to 1")
        rows, columns = self.rows_columns()
        width, height = self.width_height()
        fits = height // rows >= _LEAST_PATCH and width // columns >= _LEAST_PATCH
        require(fits, "grid", self.grid, f"patches of {_LEAST_PATCH} pixels or more a side")

    def rows_columns(self) -> tuple[int, int]:
        """Return the number of rows and columns of patches.

        >>> ImageParams(grid="4x8").rows_columns()
        (4, 8)
        """
        rows, columns = _pair("grid", self.grid)
        fits = rows * columns <= _MOST_PATCHES
        require(fits, "grid", self.grid, f"ROWSxCOLUMNS, at most {_MOST_PATCHES} patches")
        return rows, columns

    def width_height(self) -> tuple[int, int]:
        """Return the size of the working image in pixels.

        >>> ImageParams().width_height()
        (320, 240)
        """
        width, height = _pair("image-size", self.image_size)
        fits = max(width, height) <= _MOST_PIXELS
        require(fits, "image-size", self.image_size, f"at most {_MOST_PIXELS} pixels a side")
        return width, height


def _pair(key: str, text: str) -> tuple[int, int]:
    """Return the two numbers of a text like 6x6."""
    first, _, second = text.partition("x")
    digits = first.isdecimal() and second.isdecimal() and len(text) < 12  # noqa: PLR2004  # no huge numbers
    good = digits and int(first) > 0 and int(second) > 0
    require(good, key, text, "two whole numbers like 6x6")
    return int(first), int(second)
