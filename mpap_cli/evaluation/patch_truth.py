"""How well patches are told apart, where the truth is known patch by patch (section 5.3).

The simulator writes for each patch of each image which share of its pixels is floor, wall
or obstacle, and for each image how far the way ahead is free.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.roc import ordered_pairs
from mpap_cli.observations import BoolArray, Float64Array, Int8Array, IntArray
from mpap_cli.systems.decision import STRAIGHT

FREE_M = 2.0
_HALF = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class PatchPlaces:
    """Where patches lie, each array (n,): stamp of the image, row and column of the grid."""

    stamps_ns: IntArray
    rows: IntArray
    columns: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class SeenPatches:
    """What a model says of patches, each array (n,), as in patches.csv.

    ``cluster`` is -1 and ``p_obstacle`` NaN where the model has none.
    """

    places: PatchPlaces
    cluster: IntArray
    p_obstacle: Float64Array
    unknown: BoolArray


@dataclass(frozen=True, slots=True, eq=False)
class TruePatches:
    """Shares (n, 3) of the pixels of patches that are floor, wall and obstacle."""

    places: PatchPlaces
    shares: Float64Array


@dataclass(frozen=True, slots=True, eq=False)
class PairedPatches:
    """Patches with what was said and what is true; ``missing`` patches were not spoken of."""

    cluster: IntArray
    p_obstacle: Float64Array
    unknown: BoolArray
    shares: Float64Array
    missing: int


@dataclass(frozen=True, slots=True, kw_only=True)
class PatchScores:
    """How well one model tells patches apart.

    ``auc`` is of ``p_obstacle`` over all patches, positive where less than half is floor.
    ``v_measure`` compares the clusters with the kind (floor, wall, obstacle) that has the
    largest share; patches in no cluster are one cluster. None where it is not defined.
    """

    patches: int
    missing: int
    positives: int
    auc: float | None
    mean_p_floor: float | None
    mean_p_obstacle: float | None
    unknown_share: float
    homogeneity: float
    completeness: float
    v_measure: float


@dataclass(frozen=True, slots=True)
class FreeWay:
    """Share of ``straight`` among ``images`` with a free way ahead (None without any)."""

    images: int
    straight_share: float | None


def pair_patches(seen: SeenPatches, truth: TruePatches) -> PairedPatches:
    """Bring together what was said and what is true of the patches of one log.

    Parameters
    ----------
    seen : SeenPatches
        Predictions; a patch that the truth does not name is left out.
    truth : TruePatches
        Truth; a patch without prediction counts as missing.

    Returns
    -------
    PairedPatches
        In the order of the truth.
    """
    both = [np.concatenate(pair) for pair in zip(_axes(seen), _axes(truth), strict=True)]
    _, keys = np.unique(np.stack(both), axis=1, return_inverse=True)
    seen_keys, true_keys = np.split(keys.ravel(), [seen.cluster.size])
    row_of = np.full(int(keys.max(initial=-1)) + 1, -1, dtype=np.int64)
    row_of[seen_keys] = np.arange(seen_keys.size)
    row = row_of[true_keys]
    found = row >= 0
    row = row[found]
    return PairedPatches(
        cluster=seen.cluster[row],
        p_obstacle=seen.p_obstacle[row],
        unknown=seen.unknown[row],
        shares=truth.shares[found],
        missing=int(np.sum(~found)),
    )


def _axes(table: SeenPatches | TruePatches) -> tuple[IntArray, IntArray, IntArray]:
    """Return the columns that name a patch."""
    places = table.places
    return places.stamps_ns, places.rows, places.columns


def score_patches(pairs: Sequence[PairedPatches], purity: float = _HALF) -> PatchScores:
    """Score what one model says of the patches of logs.

    Parameters
    ----------
    pairs : sequence of PairedPatches
        One a log, at least one patch in all; the probabilities of one model only.
    purity : float
        Share of floor from which a patch counts for ``mean_p_floor``, and share of what
        is not floor from which one counts for ``mean_p_obstacle``. The other figures are
        always of all patches.

    Returns
    -------
    PatchScores
        Without labels there is neither an area nor a mean.
    """
    from sklearn.metrics import homogeneity_completeness_v_measure  # noqa: PLC0415  # slow

    p = np.concatenate([one.p_obstacle for one in pairs])
    cluster = np.concatenate([one.cluster for one in pairs])
    shares = np.concatenate([one.shares for one in pairs])
    floor = shares[:, 0]
    positive = floor < _HALF
    n_pairs = int(positive.sum()) * int((~positive).sum())
    spoken = bool(n_pairs) and not np.isnan(p).any()
    kinds = homogeneity_completeness_v_measure(np.argmax(shares, axis=1), cluster)
    return PatchScores(
        patches=p.size,
        missing=sum(one.missing for one in pairs),
        positives=int(positive.sum()),
        auc=ordered_pairs(p, positive) / n_pairs if spoken else None,
        mean_p_floor=_mean(p[~positive & (floor >= purity)]),
        mean_p_obstacle=_mean(p[positive & (1 - floor >= purity)]),
        unknown_share=float(np.mean(np.concatenate([one.unknown for one in pairs]))),
        homogeneity=float(kinds[0]),
        completeness=float(kinds[1]),
        v_measure=float(kinds[2]),
    )


def _mean(p: Float64Array) -> float | None:
    """Return the mean, None of nothing and where no model spoke."""
    return float(p.mean()) if p.size and not np.isnan(p).any() else None


def score_free_way(
    stamps_ns: IntArray, actions: Int8Array, truth_ns: IntArray, free_ahead_m: Float64Array
) -> FreeWay:
    """Return how often the decision is straight where more than 2 m ahead are free.

    Parameters
    ----------
    stamps_ns, actions : ndarray of shape (n,)
        Decisions of one log, indices into :data:`mpap_cli.systems.decision.ACTIONS`.
    truth_ns, free_ahead_m : ndarray of shape (m,)
        Stamps of the images, ascending, and metres to the first solid thing ahead.

    Returns
    -------
    FreeWay
        Over the images that have a decision.

    Examples
    --------
    >>> stamps_ns = np.arange(4)
    >>> score_free_way(stamps_ns, np.array([0, 1, 0, 3]), stamps_ns, np.array([5, 3, 1, 2.0]))
    FreeWay(images=2, straight_share=0.5)
    """
    _, decided, true = np.intersect1d(stamps_ns, truth_ns, return_indices=True)
    free = free_ahead_m[true] > FREE_M
    straight = actions[decided][free] == STRAIGHT
    share = float(straight.mean()) if straight.size else None
    return FreeWay(int(free.sum()), share)
