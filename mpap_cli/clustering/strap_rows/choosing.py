"""Which clusters and outliers are exemplars after a rebuild (sections 3.3 and 4.2.4)."""

import numpy as np

from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.clustering.preference import resolve_preference
from mpap_cli.clustering.strap_rows.arrays import Items
from mpap_cli.distance import similarities, squared_distances
from mpap_cli.observations import Float32Array, Float64Array, IntArray
from mpap_cli.params import AffinityParams, StrapParams

_NEAR_IN_EPS = 2.0
_MOST_FOR_MEDIAN = 1000
# More than float32 products of vectors of length 1 are off.
_ROUNDING = 1e-4
_BLOCK = 512


def choose_exemplars(
    items: Items,
    n_clusters: int,
    strap: StrapParams,
    affinity: AffinityParams,
) -> IntArray:
    """Run weighted affinity propagation over clusters and outliers (section 3.3).

    Parameters
    ----------
    items : Items
        The clusters first, then all outliers.
    n_clusters : int
        How many of the items are clusters.
    strap, affinity : StrapParams, AffinityParams
        Settings.

    Returns
    -------
    ndarray of shape (k,)
        Rows of the exemplars, ascending; clusters that took no part among them.

    Notes
    -----
    Of the clusters those take part that are within twice the fit radius of an outlier or
    within the fit radius of another cluster: others could neither take in nor join anything
    that :func:`cover` would not part again. The preference is the median over all items, of
    more than 1,000 over as many that are spread evenly among them.
    """
    clusters, outliers = np.arange(n_clusters), np.arange(n_clusters, items.n_items)
    involved = _involved(items.exemplars[clusters], items.exemplars[outliers], strap.eps)
    rows = np.concatenate([involved, outliers])
    s = similarities(items.exemplars[rows], affinity.similarity)
    weights = np.minimum(items.weight[rows], strap.weight_cap)
    preferences = np.full(len(rows), _preference(items, affinity))
    if strap.strap_distortion:
        # of as many points as the cluster weighs here; what weighs less is taken whole
        share = strap.weight_cap / np.maximum(items.weight[rows], strap.weight_cap)
        preferences -= share * items.distortion[rows]
    clustering = affinity_propagation(weights[:, None] * s, preferences, affinity)
    return np.union1d(rows[clustering.exemplars], np.setdiff1d(clusters, involved))


def _involved(clusters: Float32Array, outliers: Float32Array, eps: float) -> IntArray:
    """Return the clusters that an outlier or another cluster is near, ascending."""
    reach = (_NEAR_IN_EPS * eps) ** 2
    near_outlier = np.flatnonzero((squared_distances(clusters, outliers) < reach).any(axis=1))
    return np.union1d(near_outlier, _close_ones(clusters, eps))


def _close_ones(points: Float32Array, eps: float) -> IntArray:
    """Return the rows that have another one within the fit radius."""
    close = np.zeros(len(points), np.bool_)
    for start in range(0, len(points), _BLOCK):
        block = points[start : start + _BLOCK]
        # float32 products leave few pairs, which are then looked at in float64
        first, second = np.nonzero(block @ points.T > 1.0 - eps * eps - _ROUNDING)
        first += start
        steps = points[first].astype(np.float64) - points[second]
        within = 0.5 * np.square(steps).sum(axis=1) < eps * eps
        close[first[within & (first != second)]] = True
    return np.flatnonzero(close)


def _preference(items: Items, affinity: AffinityParams) -> float:
    """Return the median similarity of all items, or of some spread evenly among them."""
    step = -(-items.n_items // _MOST_FOR_MEDIAN)
    s = similarities(items.exemplars[::step], affinity.similarity)
    return resolve_preference(s, "median")


def cover(items: Items, exemplars: IntArray, kept: IntArray, eps: float) -> IntArray:
    """Add items to the exemplars until each of some has an exemplar within the fit radius.

    Parameters
    ----------
    items : Items
        Clusters and outliers.
    exemplars : ndarray of shape (k,)
        Rows of the exemplars so far, ascending, one or more.
    kept : ndarray of shape (n,)
        Rows that are to be covered; those that are not become exemplars themselves, the
        heaviest first, then the first.
    eps : float
        Fit radius.

    Returns
    -------
    ndarray of shape (k + added,)
        Rows, ascending.
    """
    from mpap_cli.clustering.strap_rows import _kernels  # noqa: PLC0415  # slow: numba

    rest = np.setdiff1d(kept, exemplars)
    rest = rest[np.lexsort((rest, -items.counts[rest]))]
    _, squared = _kernels.nearest(items.exemplars[rest], items.exemplars[exemplars])
    rest = rest[squared >= eps * eps]
    added: list[int] = []
    while rest.size:
        added.append(int(rest[0]))
        to_added = squared_distances(items.exemplars[rest], items.exemplars[rest[:1]])[:, 0]
        rest = rest[to_added >= eps * eps]
    return np.union1d(exemplars, np.array(added, np.int64))


def assign(items: Items, exemplars: IntArray) -> tuple[IntArray, Float64Array]:
    """Send each item to its nearest exemplar, each exemplar to itself.

    Parameters
    ----------
    items : Items
        n items.
    exemplars : ndarray of shape (k,)
        Rows of the exemplars.

    Returns
    -------
    tuple of ndarray of shape (n,)
        Index into ``exemplars`` and squared distance, for each item.
    """
    from mpap_cli.clustering.strap_rows import _kernels  # noqa: PLC0415  # slow: numba

    labels, squared = _kernels.nearest(items.exemplars, items.exemplars[exemplars])
    labels[exemplars], squared[exemplars] = np.arange(len(exemplars)), 0.0
    return labels, squared
