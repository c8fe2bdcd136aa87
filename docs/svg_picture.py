"""Shapes and words as SVG, for the schematics."""

from xml.sax.saxutils import escape

INK, PALE = "#282828", "#6E6E6E"
BLUE, VERMILION, GREEN, GRAY = "#0072B2", "#D55E00", "#009E73", "#8C8C8C"
TINTS = {BLUE: "#E3EFF7", VERMILION: "#FBEADF", GREEN: "#E0F3EE", GRAY: "#F1F1F1"}
FONT = "Helvetica, Arial, sans-serif"
# Boxes are of one size.
WIDE, HIGH = 164, 92

Point = tuple[int, int]


class Picture:
    """Shapes on white paper, in pixels from the upper left corner."""

    def __init__(self, width: int, height: int, title: str) -> None:
        self.width = width
        self.height = height
        self.title = title
        self.shapes: list[str] = []

    def box(self, corner: Point, color: str, words: tuple[str, ...]) -> None:
        """Draw a box with a heading and lines below it."""
        x, y = corner
        self.shapes.append(
            f'<rect x="{x}" y="{y}" width="{WIDE}" height="{HIGH}" rx="8" '
            f'fill="{TINTS[color]}" stroke="{color}" stroke-width="2"/>'
        )
        middle = x + WIDE // 2
        below = 18
        first = y + (HIGH - below * (len(words) - 1)) // 2 + 5
        for index, line in enumerate(words):
            self.text((middle, first + below * index), line, bold=index == 0, align="middle")

    def text(
        self,
        at: Point,
        words: str,
        *,
        bold: bool = False,
        align: str = "start",
        color: str = INK,
        size: int = 13,
    ) -> None:
        """Write one line; ``at`` is on its base line."""
        weight = ' font-weight="bold"' if bold else ""
        self.shapes.append(
            f'<text x="{at[0]}" y="{at[1]}" font-size="{size}" text-anchor="{align}" '
            f'fill="{color}"{weight}>{escape(words)}</text>'
        )

    def arrow(self, *points: Point, width: float = 1.8, opacity: float = 1.0) -> None:
        """Draw an arrow along corners."""
        places = " ".join(f"{x},{y}" for x, y in points)
        faint = "" if opacity == 1 else f' opacity="{opacity:g}"'
        self.shapes.append(
            f'<polyline points="{places}" fill="none" stroke="{INK}" '
            f'stroke-width="{width:g}"{faint} marker-end="url(#head)"/>'
        )

    def circle(self, at: Point, radius: int, color: str, *, dashed: bool = False) -> None:
        """Draw a circle, filled palely."""
        dashes = ' stroke-dasharray="6 4"' if dashed else ""
        self.shapes.append(
            f'<circle cx="{at[0]}" cy="{at[1]}" r="{radius}" fill="{TINTS[color]}" '
            f'fill-opacity="0.7" stroke="{color}" stroke-width="2"{dashes}/>'
        )

    def dots(self, color: str, *places: Point) -> None:
        """Draw small dots."""
        self.shapes += [f'<circle cx="{x}" cy="{y}" r="3.5" fill="{color}"/>' for x, y in places]

    def svg(self) -> str:
        """Return the file."""
        head = (
            '<marker id="head" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" '
            f'markerHeight="7" orient="auto"><path d="M0,0 L10,5 L0,10 z" fill="{INK}"/></marker>'
        )
        size = f'viewBox="0 0 {self.width} {self.height}" width="{self.width}"'
        lines = (
            f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="{FONT}" role="img">',
            f"<title>{escape(self.title)}</title>",
            f"<defs>{head}</defs>",
            f'<rect width="{self.width}" height="{self.height}" fill="white"/>',
            *self.shapes,
            "</svg>",
        )
        return "\n".join(lines) + "\n"
