"""Tables of patches and images read back: patches.csv, and the truth of the simulator."""

import csv
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mpap_cli.errors import LogError, UsageError
from mpap_cli.evaluation.patch_truth import PatchPlaces, SeenPatches, TruePatches
from mpap_cli.observations import Float64Array, IntArray

Number = Callable[[str], int | float]

# Stamps are read as whole numbers, since a float would lose their last digits.
_PLACES: Mapping[str, Number] = {"stamp_ns": int, "row": int, "column": int}
_SHARES: Mapping[str, Number] = {"floor": float, "wall": float, "obstacle": float}


def read_seen_patches(path: Path, log_index: int) -> SeenPatches:
    """Read what a model says of the patches of one log.

    Parameters
    ----------
    path : Path
        A ``patches.csv``; an empty cluster reads -1, an empty probability NaN.
    log_index : int
        Which log of it.

    Raises
    ------
    LogError
        If the file cannot be read.
    UsageError
        If it is no such table.
    """
    said: Mapping[str, Number] = {"cluster": _cluster, "p_obstacle": _probability, "unknown": int}
    found = _read_columns(path, {"log_index": int, **_PLACES, **said})
    mine = found["log_index"] == log_index
    return SeenPatches(
        PatchPlaces(*(found[name][mine] for name in _PLACES)),
        found["cluster"][mine],
        found["p_obstacle"][mine],
        found["unknown"][mine] == 1,
    )


def read_true_patches(path: Path) -> TruePatches:
    """Read the truth of the patches of one log, ``LOG.patches.csv``.

    Raises
    ------
    LogError
        If the file cannot be read.
    UsageError
        If it is no such table.
    """
    found = _read_columns(path, {**_PLACES, **_SHARES})
    shares = np.stack([found[name] for name in _SHARES], axis=1)
    return TruePatches(PatchPlaces(*(found[name] for name in _PLACES)), shares)


def read_free_ahead(path: Path) -> tuple[IntArray, Float64Array]:
    """Read stamps and free metres ahead of the images of one log, ``LOG.images.csv``.

    Raises
    ------
    LogError
        If the file cannot be read.
    UsageError
        If it is no such table.
    """
    found = _read_columns(path, {"stamp_ns": int, "free_ahead_m": float})
    return found["stamp_ns"], found["free_ahead_m"]


def _read_columns(path: Path, wanted: Mapping[str, Number]) -> dict[str, NDArray[Any]]:
    """Return the named columns, int64 or float64, each (n,)."""
    try:
        with path.open(encoding="utf-8", newline="") as file:
            reader = csv.reader(file, strict=True)
            header = next(reader, [])
            missing = [name for name in wanted if name not in header]
            if missing:
                named = ", ".join(header) or "no column"
                msg = f"{path.name}: no {', '.join(missing)} among {named}; give the right table"
                raise UsageError(msg)
            table = list(reader)
        return {
            name: _column([row[header.index(name)] for row in table], number)
            for name, number in wanted.items()
        }
    except OSError as err:
        msg = f"{path}: {err.strerror or err}; give a table of patches or images"
        raise LogError(msg) from err
    except (ValueError, IndexError, csv.Error) as err:
        msg = f"{path.name}: not a whole table of numbers in UTF-8 ({err}); write it again"
        raise UsageError(msg) from err


def _column(cells: list[str], number: Number) -> NDArray[Any]:
    """Turn the cells of one column into an array."""
    is_whole = number in (int, _cluster)
    dtype: type[np.generic] = np.int64 if is_whole else np.float64
    return np.array([number(cell) for cell in cells], dtype=dtype)


def _cluster(cell: str) -> int:
    """Read the number of a cluster, -1 where there is none."""
    return int(cell or -1)


def _probability(cell: str) -> float:
    """Read a probability, NaN where there is none."""
    return float(cell or "nan")
