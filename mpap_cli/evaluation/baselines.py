"""Baselines: what the same labels give without meta-points (section 5.2).

Each is fitted on the scans and labels that the model of the fold learnt from, and then
scores the scans of the fold. Those that need scikit-learn import it when they run.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mpap_cli.distance import squared_distances
from mpap_cli.observations import BoolArray, Float64Array, FloatArray
from mpap_cli.properties.kernel import Kernel, kernel_mean

MAX_TRAIN = 10_000
MAX_CENTRES = 200
N_TREES = 100
BLOCK = 256


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadOut:
    """What the baselines share with the model: its kernel, and the seed.

    ``theta`` is the width of the kernel (a distance), ``neighbors`` how many references
    are asked, ``prior_counts`` the pseudo-counts at the base rate, ``n_centers`` the
    number of meta-points of the model.
    """

    theta: float
    neighbors: int
    prior_counts: float
    n_centers: int
    seed: int


Fitted = Callable[[FloatArray], tuple[Float64Array, Float64Array]]
"""Rows of one or more scans to scores and probabilities, both (n,)."""

Fit = Callable[[FloatArray, BoolArray, ReadOut], Fitted]
"""Rows (n, d) and labels (n,) of both classes to a fitted baseline."""


@dataclass(frozen=True, slots=True)
class Baseline:
    """A baseline: which rows it looks at, and its fit.

    ``nearest`` is the nearest range ahead in the scan itself, ``nearest-1s`` that all
    round over the last second, ``raw`` the plain bins, ``features`` those of the model.
    """

    rows: str
    fit: Fit

    @property
    def is_range(self) -> bool:
        """Whether it is one range, which scores without a fit."""
        return self.rows.startswith("nearest")


def fit_nearest(rows: FloatArray, labels: BoolArray, read_out: ReadOut) -> Fitted:
    """Score by one range alone; a logistic fit gives the probability."""
    logistic = fit_logistic(rows, labels, read_out)

    def score(tested: FloatArray) -> tuple[Float64Array, Float64Array]:
        return nearest_score(tested), logistic(tested)[1]

    return score


def nearest_score(range_m: FloatArray) -> Float64Array:
    """Return minus the range in metres, (n, 1) to (n,): the nearer, the higher."""
    return -range_m[:, 0].astype(np.float64)


def fit_logistic(rows: FloatArray, labels: BoolArray, read_out: ReadOut) -> Fitted:
    """Logistic regression on standardised values, with scikit-learn's defaults."""
    from sklearn.linear_model import LogisticRegression  # noqa: PLC0415  # start-up
    from sklearn.pipeline import make_pipeline  # noqa: PLC0415  # start-up
    from sklearn.preprocessing import StandardScaler  # noqa: PLC0415  # start-up

    regression = LogisticRegression(max_iter=1000, random_state=read_out.seed)
    model = make_pipeline(StandardScaler(), regression)
    model.fit(rows.astype(np.float64), labels)

    def score(tested: FloatArray) -> tuple[Float64Array, Float64Array]:
        p = model.predict_proba(tested.astype(np.float64))[:, 1]
        return model.decision_function(tested.astype(np.float64)), p

    return score


def fit_forest(rows: FloatArray, labels: BoolArray, read_out: ReadOut) -> Fitted:
    """Random forest of a hundred trees, with scikit-learn's defaults, on one thread."""
    from sklearn.ensemble import RandomForestClassifier  # noqa: PLC0415  # start-up

    model = RandomForestClassifier(N_TREES, random_state=read_out.seed, n_jobs=1)
    model.fit(rows, labels)

    def score(tested: FloatArray) -> tuple[Float64Array, Float64Array]:
        p = model.predict_proba(tested)[:, 1]
        return p, p

    return score


def fit_scans(rows: FloatArray, labels: BoolArray, read_out: ReadOut) -> Fitted:
    """Kernel read-out over the nearest single scans, each with its own label."""
    return _kernel_over(rows, labels.astype(np.float64), np.ones(labels.size), read_out)


def fit_centers(rows: FloatArray, labels: BoolArray, read_out: ReadOut) -> Fitted:
    """Kernel read-out over k-means centers, as many as the model has meta-points.

    At most ``MAX_CENTRES``, and not more than there are distinct scans. Centers are
    brought back to length 1, like the means of meta-points.
    """
    from sklearn.cluster import KMeans  # noqa: PLC0415  # start-up
    from threadpoolctl import threadpool_limits  # noqa: PLC0415  # start-up

    distinct = np.unique(rows, axis=0).shape[0]
    n_centers = max(1, min(read_out.n_centers, MAX_CENTRES, distinct))
    model = KMeans(n_centers, n_init=1, random_state=read_out.seed)
    # Sums over threads come in any order; one thread gives the same centers each time.
    with threadpool_limits(limits=1):
        member = model.fit_predict(rows)
    centers = model.cluster_centers_.astype(np.float64)
    lengths = np.linalg.norm(centers, axis=1, keepdims=True)
    centers /= np.where(lengths > 0, lengths, 1.0)
    counts = np.bincount(member, minlength=n_centers).astype(np.float64)
    positives = np.bincount(member[labels], minlength=n_centers).astype(np.float64)
    return _kernel_over(centers, positives, counts, read_out)


def training_sample(labels: BoolArray, seed: int) -> BoolArray:
    """Mark the scans to fit on: all, or a random ``MAX_TRAIN`` of them.

    Baselines grow with the number of scans, other than meta-points.
    """
    chosen = np.ones(labels.size, dtype=np.bool_)
    if labels.size > MAX_TRAIN:
        order = np.random.default_rng(seed).permutation(labels.size)
        chosen[order[MAX_TRAIN:]] = False
    return chosen


def _kernel_over(
    references: FloatArray, positives: Float64Array, counts: Float64Array, read_out: ReadOut
) -> Fitted:
    """Weight the counts of the nearest references by exp(-d^2 / 2 theta^2)."""
    fixed = references.astype(np.float64)
    pairs = np.stack([counts - positives, positives], axis=1).astype(np.int64)
    base = float(positives.sum() / counts.sum())
    kernel = Kernel(read_out.theta, read_out.neighbors, read_out.prior_counts)

    def probability(rows: Float64Array) -> Float64Array:
        return kernel_mean(squared_distances(rows, fixed), pairs, base, kernel)

    def score(tested: FloatArray) -> tuple[Float64Array, Float64Array]:
        parts = [
            probability(tested[at : at + BLOCK].astype(np.float64))
            for at in range(0, tested.shape[0], BLOCK)
        ]
        p = np.concatenate(parts)
        return p, p

    return score


BASELINES: dict[str, Baseline] = {
    "nearest-range": Baseline("nearest", fit_nearest),
    "nearest-range-1s": Baseline("nearest-1s", fit_nearest),
    "logistic-regression": Baseline("raw", fit_logistic),
    "random-forest": Baseline("raw", fit_forest),
    "knn-scans": Baseline("features", fit_scans),
    "k-means": Baseline("features", fit_centers),
}
