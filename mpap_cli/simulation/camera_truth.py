"""What the images of a simulated log truly show, and how far the way ahead is free."""

import contextlib
import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self, TextIO

import numpy as np

from mpap_cli.errors import OutputError
from mpap_cli.observations import Float64Array, IntArray
from mpap_cli.simulation.palettes import FLOORS, NAMES, WALLS
from mpap_cli.simulation.rendering.arrays import Image
from mpap_cli.simulation.rendering.pixels._kernels import count_cells
from mpap_cli.simulation.shapes import Shapes

GRID = (6, 6)
PATCH_COLUMNS = {
    "log": "base name of the log",
    "stamp_ns": "time of the image in the log, nanoseconds",
    "row": "row of the patch, from the top, from 0",
    "column": "column, from the left, from 0",
    "floor": "share of its pixels that show floor",
    "wall": "share that shows wall",
    "obstacle": "share that shows anything else",
}
IMAGE_COLUMNS = {
    "log": "base name of the log",
    "stamp_ns": "time of the image in the log, nanoseconds",
    "free_ahead_m": "meters to the first thing that the robot's width would meet",
}
_KINDS = np.array([0 if name in FLOORS else 1 if name in WALLS else 2 for name in NAMES])


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """Truth about one image: shares (36, 3) of floor, wall, obstacle, and metres ahead."""

    shares: Float64Array
    free_ahead_m: float


def cell_edges(n_pixels: int, n_cells: int) -> IntArray:
    """Return where the cells of a grid begin and end; what is left over is split.

    >>> cell_edges(320, 6).tolist()
    [1, 54, 107, 160, 213, 266, 319]
    """
    side = n_pixels // n_cells
    return np.arange(n_cells + 1) * side + (n_pixels - n_cells * side) // 2


def material_counts(labels: Image) -> IntArray:
    """Return the pixels of each material of ``NAMES`` in each patch, (36, n_names)."""
    rows, columns = (cell_edges(n, cells) for n, cells in zip(labels.shape, GRID, strict=True))
    return count_cells(labels, rows, columns, len(NAMES))


def kind_shares(counts: IntArray) -> Float64Array:
    """Return the shares of floor, wall and obstacle (n, 3) from counts of materials."""
    kinds = np.stack([counts[:, kind == _KINDS].sum(axis=1) for kind in range(3)], axis=1)
    return np.asarray(kinds / counts.sum(axis=1, keepdims=True))


def free_ahead(solid: Shapes, pose: Float64Array, radius_m: float) -> float:
    """Return how far ahead of a robot the first solid thing is that its width would meet.

    Parameters
    ----------
    solid : Shapes
        What stops it.
    pose : ndarray of shape (3,)
        x, y, heading of the robot; metres and radians.
    radius_m : float
        Half of its width; distances count from its front.

    Returns
    -------
    float
        Metres, zero or above; infinite where nothing is ahead.

    Examples
    --------
    >>> wall = Shapes(np.array([[2.0, -1.0, 2.0, 1.0]]), np.empty((0, 3)))
    >>> free_ahead(wall, np.zeros(3), 0.2)
    1.8
    """
    x, y, heading = pose.tolist()
    c, s = math.cos(heading), math.sin(heading)
    turn = np.array(((c, -s), (s, c)))
    ends = (solid.segments.reshape(-1, 2, 2) - (x, y)) @ turn
    middles = (solid.circles[:, :2] - (x, y)) @ turn
    nearest = min(_segments_ahead(ends, radius_m), _circles_ahead(middles, solid, radius_m))
    return max(nearest - radius_m, 0.0)


def _segments_ahead(ends: Float64Array, half_width_m: float) -> float:
    """Return how far ahead the first piece of a segment within the corridor is."""
    first, last = ends[:, 0], ends[:, 1]
    along = last - first
    across = np.where(np.abs(along[:, 1]) < 1e-12, 1e-12, along[:, 1])  # noqa: PLR2004  # parallel
    sides = np.stack(
        ((-half_width_m - first[:, 1]) / across, (half_width_m - first[:, 1]) / across)
    )
    enter, leave = np.maximum(sides.min(axis=0), 0.0), np.minimum(sides.max(axis=0), 1.0)
    ahead = np.stack((first[:, 0] + enter * along[:, 0], first[:, 0] + leave * along[:, 0]))
    ahead = ahead[:, (enter <= leave) & (ahead.max(axis=0) > 0)]
    return float(np.maximum(ahead.min(axis=0), 0.0).min(initial=math.inf))


def _circles_ahead(middles: Float64Array, solid: Shapes, half_width_m: float) -> float:
    """Return how far ahead the first piece of a circle within the corridor is."""
    radius = solid.circles[:, 2]
    aside = np.maximum(np.abs(middles[:, 1]) - half_width_m, 0.0)
    ahead = middles[:, 0] - np.sqrt(np.maximum(radius**2 - aside**2, 0.0))
    within = (aside < radius) & (middles[:, 0] > 0)
    return float(np.maximum(ahead[within], 0.0).min(initial=math.inf))


class CameraTruth:
    """Writes the two tables of truth about images beside a log, row by row.

    Used as a context manager; after an error neither table is left.

    Parameters
    ----------
    log : str
        Name of the log, for the first column.
    patches_path, images_path : Path
        The tables; must not exist.
    """

    def __init__(self, log: str, patches_path: Path, images_path: Path) -> None:
        self._log = log
        self._paths = (patches_path, images_path)

    def add(self, stamp_ns: int, sight: Sight) -> None:
        """Append what the image of a message shows; the stamp is log time."""
        self._images.writerow((self._log, stamp_ns, f"{sight.free_ahead_m:.3f}"))
        for i, shares in enumerate(sight.shares.tolist()):
            row, column = divmod(i, GRID[1])
            cells = [f"{share:.4f}" for share in shares]
            self._patches.writerow((self._log, stamp_ns, row, column, *cells))

    def __enter__(self) -> Self:
        with contextlib.ExitStack() as opened:
            files = [opened.enter_context(_new_table(path)) for path in self._paths]
            self._close = opened.pop_all()
        self._patches, self._images = (csv.writer(file, lineterminator="\n") for file in files)
        self._patches.writerow(PATCH_COLUMNS)
        self._images.writerow(IMAGE_COLUMNS)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._close.__exit__(kind, error, trace)


@contextlib.contextmanager
def _new_table(path: Path) -> Iterator[TextIO]:
    """Open a table that is not there yet; after an error it is removed."""
    try:
        file = path.open("x", encoding="utf-8", newline="")
    except OSError as err:
        msg = f"{path}: cannot be written ({err.strerror}); choose another place"
        raise OutputError(msg) from err
    try:
        with file:
            yield file
    except BaseException:
        path.unlink()
        raise
