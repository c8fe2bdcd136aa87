"""Compiled loops over finished images: noise, and counts of what patches show."""

import numpy as np
from numba import njit

from mpap_cli.observations import Int8Array, IntArray
from mpap_cli.simulation.rendering.arrays import Image

I64 = IntArray
U8 = Image


@njit(nogil=True, cache=True, error_model="numpy")
def _add_noise(image: U8, noise: Int8Array, start: int) -> None:
    """Add a piece of a long ring of noise to every value."""
    flat = image.reshape(-1)
    mask = noise.size - 1
    for i in range(flat.size):
        value = np.int32(flat[i]) + np.int32(noise[(start + i) & mask])
        flat[i] = np.uint8(min(max(value, np.int32(0)), np.int32(255)))


@njit(nogil=True, cache=True, error_model="numpy")
def _count_cells(labels: U8, rows: I64, columns: I64, counts: I64) -> None:
    """Count the pixels of each label in the cells of a grid given by its edges."""
    for i in range(rows.size - 1):
        for j in range(columns.size - 1):
            cell = i * (columns.size - 1) + j
            for r in range(rows[i], rows[i + 1]):
                for c in range(columns[j], columns[j + 1]):
                    counts[cell, labels[r, c]] += 1


def add_noise(image: U8, noise: Int8Array, start: int) -> None:
    """Add a piece of a ring of noise, of a length that is a power of two, to every value."""
    _add_noise(image, noise, start)


def count_cells(labels: U8, rows: I64, columns: I64, n_labels: int) -> I64:
    """Return how often each label is in each cell of a grid, (n_cells, n_labels).

    ``rows`` and ``columns`` are the edges of the cells, one more than there are cells.
    """
    counts = np.zeros(((rows.size - 1) * (columns.size - 1), n_labels), np.int64)
    _count_cells(labels, rows, columns, counts)
    return counts
