"""Compiled loops over described pixels: histograms of every patch, and their embedding."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mpap_cli.observations import Float32Array, IntArray

U8 = NDArray[np.uint8]
U16 = NDArray[np.uint16]
I32 = NDArray[np.int32]
I64 = IntArray
F32 = Float32Array

CHANNEL_BINS = 16
COLOR_BINS = 3 * CHANNEL_BINS
TEXTURE_BINS = 59

_N_CODES = 256
_MOST_COUNTED = 65_535
_ONE = np.uint16(1)


@njit(nogil=True, cache=True, error_model="numpy")
def _count_pixels(index: U16, codes: U8, colors: U16, textures: U16) -> None:
    """Count the pixels of one patch by index and by code.

    Even rows and odd ones have tables of their own (the first axis): a counter that was
    just written need not be read again at once.
    """
    colors[:] = 0
    textures[:] = 0
    color, other_color = colors[0], colors[1]
    texture, other_texture = textures[0], textures[1]
    for y in range(0, index.shape[0] - 1, 2):
        first, second = index[y], index[y + 1]
        third, fourth = codes[y], codes[y + 1]
        for x in range(first.size):
            color[first[x]] += _ONE
            other_color[second[x]] += _ONE
            texture[third[x]] += _ONE
            other_texture[fourth[x]] += _ONE
    if index.shape[0] % 2 == 1:
        for x in range(index.shape[1]):
            color[index[-1, x]] += _ONE
            texture[codes[-1, x]] += _ONE


@njit(nogil=True, cache=True, error_model="numpy")
def _add_counts(colors: U16, textures: U16, uniform: I64, n_pixels: int, counts: I32) -> None:
    """Add what was counted to the histograms of one patch: hue, saturation, value, texture."""
    joint = colors[0]
    for j in range(joint.size):
        joint[j] += colors[1, j]
    planes = joint.reshape(CHANNEL_BINS, -1)
    hues = np.zeros(planes.shape[1], np.int32)
    for v in range(CHANNEL_BINS):
        for j in range(hues.size):
            hues[j] += np.int32(planes[v, j])
    for v in range(CHANNEL_BINS):
        total = np.int32(0)
        for j in range(hues.size):
            total += np.int32(planes[v, j])
        counts[2 * CHANNEL_BINS + v] += total
    square = hues.reshape(CHANNEL_BINS, CHANNEL_BINS)
    for h in range(CHANNEL_BINS):
        total = np.int32(0)
        for s in range(CHANNEL_BINS):
            total += square[h, s]
        counts[h] += total
        for s in range(CHANNEL_BINS):
            counts[CHANNEL_BINS + s] += square[h, s]
    rest = np.int32(n_pixels)
    for k in range(uniform.size):
        code = uniform[k]
        n = np.int32(textures[0, code]) + np.int32(textures[1, code])
        counts[COLOR_BINS + k] += n
        rest -= n
    counts[COLOR_BINS + uniform.size] += rest


@njit(nogil=True, cache=True, error_model="numpy")
def _count_patches(index: U16, codes: U8, grid: I64, uniform: I64, counts: I32) -> None:
    """Count the pixels of every patch, patches row by row of the grid."""
    rows, columns, height, width, top, left = grid
    # So many rows that a counter of 16 bits holds all pixels of a patch in them.
    n_strip = min(height, _MOST_COUNTED // width)
    colors = np.empty((2, CHANNEL_BINS**3), np.uint16)
    textures = np.empty((2, _N_CODES), np.uint16)
    counts[:] = 0
    for p in range(rows * columns):
        first, low = top + p // columns * height, left + p % columns * width
        last, high = first + height, low + width
        for start in range(first, last, n_strip):
            stop = min(start + n_strip, last)
            strip = (slice(start, stop), slice(low, high))
            _count_pixels(index[strip], codes[strip], colors, textures)
            _add_counts(colors, textures, uniform, (stop - start) * width, counts[p])
        # The border of the image has no patterns; it was counted as code 0, the first bin.
        n_rows = height - np.int32(first == 0) - np.int32(last == index.shape[0])
        n_columns = width - np.int32(low == 0) - np.int32(high == index.shape[1])
        counts[p, COLOR_BINS] -= np.int32(height * width - n_rows * n_columns)


@njit(nogil=True, cache=True, error_model="numpy")
def _embed_counts(counts: I32, color_weight: float, features: F32) -> None:
    """Write the embedded histograms of patches: the roots of their weighted shares."""
    texture_at = COLOR_BINS + 1
    for p in range(counts.shape[0]):
        color_mass = texture_mass = 0
        for j in range(COLOR_BINS):
            color_mass += counts[p, j]
        for j in range(COLOR_BINS, COLOR_BINS + TEXTURE_BINS):
            texture_mass += counts[p, j]
        for j in range(COLOR_BINS):
            share = color_weight * counts[p, j] / color_mass
            features[p, j] = np.float32(np.sqrt(share))
        for j in range(TEXTURE_BINS):
            share = (1 - color_weight) * counts[p, COLOR_BINS + j] / texture_mass
            features[p, texture_at + j] = np.float32(np.sqrt(share))
        # No patch is empty: the extra coordinates of embed() for an empty histogram are 0.
        features[p, COLOR_BINS] = features[p, texture_at + TEXTURE_BINS] = np.float32(0)


def count_patches(index: U16, codes: U8, grid: I64, uniform: I64) -> I32:
    """Return how many pixels of each patch are in each bin, (n_patches, 48 + 59).

    ``index`` and ``codes`` (H, W) describe the pixels; ``grid`` holds the fields of
    PatchGrid in order; ``uniform`` (58,) are the codes that have a bin of their own.
    """
    counts = np.empty((int(grid[0] * grid[1]), COLOR_BINS + TEXTURE_BINS), np.int32)
    _count_patches(index, codes, grid, uniform, counts)
    return counts


def embed_counts(counts: I32, color_weight: float, features: F32) -> None:
    """Write the embedded histograms (n_patches, 48 + 1 + 59 + 1) of counted patches."""
    _embed_counts(counts, color_weight, features)
