"""Data made with seeds: 96-dimensional streams, and the Gaussians of Table 3."""

import numpy as np
from numpy.typing import NDArray

from mpap_cli.distance import embed

F32 = NDArray[np.float32]
N_POINTS = 48_600  # 1,350 images of 6 x 6 patches, as the paper has them
_BINS = 95  # 96 dimensions with the coordinate of the empty histogram
_PATCH_BINS = 108
THETA, MIN_POINTS = 0.2, 5


def clean_stream() -> F32:
    """Return points in 546 groups that lie apart: every point is near one center."""
    rng = np.random.default_rng(0)
    centers = rng.dirichlet(np.full(_BINS, 0.5), size=546)
    return _scattered(rng, centers[rng.integers(546, size=N_POINTS)], concentration=1500.0)


def hard_stream() -> F32:
    """Return points anywhere between two ends of 120 pairs, scattered by about theta.

    The search can rule out little, and thousands of noise-points come up.
    """
    rng = np.random.default_rng(1)
    ends = rng.dirichlet(np.full(_BINS, 0.5), size=(2, 120))
    pair, share = rng.integers(120, size=N_POINTS), rng.random((N_POINTS, 1))
    mixed = share * ends[0, pair] + (1.0 - share) * ends[1, pair]
    return _scattered(rng, mixed, concentration=400.0)


def coherent_stream() -> F32:
    """Return points that come one after the other as a robot meets them that drives slowly.

    Each goes a small step from the one before, between two ends of the hard stream, and is
    scattered by about a fifth of theta; every 300 points the robot is elsewhere.
    """
    rng = np.random.default_rng(2)
    ends = rng.dirichlet(np.full(_BINS, 0.5), size=(2, 120))
    n_drives = N_POINTS // 300
    pair = np.repeat(rng.integers(120, size=n_drives), 300)
    start = np.repeat(rng.random(n_drives), 300)
    share = np.abs((start + 0.002 * np.tile(np.arange(300), n_drives)) % 2.0 - 1.0)[:, None]
    mixed = share * ends[0, pair] + (1.0 - share) * ends[1, pair]
    return _scattered(rng, mixed, concentration=8000.0)


def _scattered(rng: np.random.Generator, shares: NDArray[np.float64], concentration: float) -> F32:
    """Draw a histogram around each of the given ones and embed it."""
    # gammas that are divided by their sum, as the embedding does, are a Dirichlet sample
    histograms = rng.standard_gamma(concentration * shares + 1e-3)
    return embed(histograms.astype(np.float32)).astype(np.float32)


def gaussians(n: int, seed: int = 0) -> F32:
    """Return n points of 10 Gaussians in the plane, centers 8 and more deviations apart."""
    rng = np.random.default_rng(seed)
    places = np.stack(np.meshgrid(np.arange(4) * 10.0, np.arange(3) * 10.0), axis=-1)
    centers = places.reshape(-1, 2)[:10] + rng.uniform(-1, 1, (10, 2))
    points = centers[rng.integers(10, size=n)] + rng.standard_normal((n, 2))
    return points.astype(np.float32)


def patch_stream(n_kinds: int, n: int, spread: float, seed: int = 0) -> F32:
    """Return n points of 109 dimensions, of so many kinds, in directions of their own.

    The kinds are the same for every seed; a point lies at about ``spread`` from its kind,
    some at half of that or twice as far.
    """
    kinds = embed(np.random.default_rng(n_kinds).dirichlet(np.full(_PATCH_BINS, 0.4), n_kinds))
    rng = np.random.default_rng((seed, n))
    lengths = spread * np.sqrt(2.0) * rng.gamma(8.0, 1 / 8, (n, 1))
    steps = rng.standard_normal((n, kinds.shape[1])) / np.sqrt(kinds.shape[1])
    points = kinds[rng.integers(n_kinds, size=n)] + lengths * steps
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    made: F32 = points.astype(np.float32)
    return made
