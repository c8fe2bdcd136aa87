"""The counts of patches equal bincounts over their pixels."""

from dataclasses import astuple

import numpy as np
import pytest
from numpy.typing import NDArray

from mpap_cli.distance import embed
from mpap_cli.features.images import _kernels
from mpap_cli.features.images.lbp import uniform_codes
from mpap_cli.features.images.patches import PatchGrid
from mpap_cli.observations import FloatArray, IntArray

U16 = NDArray[np.uint16]
U8 = NDArray[np.uint8]
UNIFORM = uniform_codes()
GRIDS = {
    "remainder": PatchGrid(2, 3, 10, 13, 1, 2),
    "to the border": PatchGrid(2, 3, 12, 15, 0, 0),
    "odd rows": PatchGrid(1, 2, 9, 8, 2, 3),
    "one patch": PatchGrid(1, 1, 24, 45, 0, 0),
}


def counted(index: U16, codes: U8, grid: PatchGrid) -> IntArray:
    """Count by numpy, patch after patch."""
    bins = np.full(256, 58)
    bins[UNIFORM] = np.arange(58)
    inside = np.zeros(index.shape, np.bool_)
    inside[1:-1, 1:-1] = True
    rows = []
    for i in range(grid.rows):
        for j in range(grid.columns):
            top, left = grid.top + i * grid.height, grid.left + j * grid.width
            place = (slice(top, top + grid.height), slice(left, left + grid.width))
            joint, patterns = index[place].ravel(), bins[codes[place][inside[place]]]
            levels = [joint // 16 % 16, joint % 16, joint // 256]
            colors = [np.bincount(level, minlength=16) for level in levels]
            rows.append(np.concatenate([*colors, np.bincount(patterns, minlength=59)]))
    return np.array(rows)


def described(shape: tuple[int, int], highest: int = 4096) -> tuple[U16, U8]:
    """Return random indices, and codes that are 0 at the border."""
    rng = np.random.default_rng(0)
    index = rng.integers(0, highest, shape).astype(np.uint16)
    codes = rng.integers(0, 256, shape).astype(np.uint8)
    codes[[0, -1]] = 0
    codes[:, [0, -1]] = 0
    return index, codes


def count(index: U16, codes: U8, grid: PatchGrid) -> NDArray[np.int32]:
    """Count by the kernel."""
    return _kernels.count_patches(index, codes, np.array(astuple(grid), np.int64), UNIFORM)


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
@pytest.mark.parametrize("highest", [4096, 1])
def test_counts_equal_bincounts(grid: PatchGrid, highest: int) -> None:
    """Whether or not patches touch the border, and all pixels are alike."""
    index, codes = described((24, 45), highest)

    counts = count(index, codes, grid)

    np.testing.assert_array_equal(counts, counted(index, codes, grid))
    assert (counts[:, :16].sum(axis=1) == grid.height * grid.width).all()


def test_patches_of_more_than_65535_equal_pixels_are_counted() -> None:
    """Counters of 16 bits are emptied before they are full."""
    index, codes = described((300, 400), 1)
    codes[:] = 0
    grid = PatchGrid(1, 1, 299, 400, 1, 0)

    counts = count(index, codes, grid)

    np.testing.assert_array_equal(counts, counted(index, codes, grid))
    assert counts[0, 0] == 299 * 400


@pytest.mark.parametrize("weight", [0.0, 0.25, 0.5, 1.0])
def test_embedded_counts_are_weighted_roots_of_shares(weight: float) -> None:
    """As equation 7 wants it: each histogram embedded by itself, then joined by weight."""
    counts = count(*described((24, 45)), GRIDS["remainder"])
    parts: list[FloatArray] = [embed(counts[:, :48]), embed(counts[:, 48:])]
    features = np.full((6, 109), np.nan, np.float32)

    _kernels.embed_counts(counts, weight, features)

    expected = np.concatenate([np.sqrt(weight) * parts[0], np.sqrt(1 - weight) * parts[1]], axis=1)
    np.testing.assert_allclose(features, expected, rtol=1e-6, atol=1e-7)
    np.testing.assert_allclose(np.linalg.norm(features, axis=1), 1.0, rtol=1e-6)


def test_kernels_run_uncompiled(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same code, line by line, gives the same."""
    grid = PatchGrid(1, 2, 3, 4, 0, 0)
    described_pixels = described((3, 8))
    counts = count(*described_pixels, grid)
    features, plain_features = np.empty((2, 2, 109), np.float32)
    _kernels.embed_counts(counts, 0.5, features)
    for name in ("_count_pixels", "_add_counts", "_count_patches", "_embed_counts"):
        monkeypatch.setattr(_kernels, name, getattr(_kernels, name).py_func)

    plain = count(*described_pixels, grid)
    _kernels.embed_counts(plain, 0.5, plain_features)

    np.testing.assert_array_equal(plain, counts)
    np.testing.assert_array_equal(plain_features, features)
