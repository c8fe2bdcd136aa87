"""Affinity propagation (section 3.2 of the paper; Frey and Dueck 2007)."""

import numpy as np

from mpap_cli.clustering.message_passing import Run, run_until_converged
from mpap_cli.observations import BoolArray, Clustering, Float64Array, IntArray
from mpap_cli.params import AffinityParams


def affinity_propagation(
    similarities: Float64Array, preference: float | Float64Array, params: AffinityParams
) -> Clustering:
    """Cluster items by passing messages between them (equations 4 to 6).

    Parameters
    ----------
    similarities : ndarray of shape (n, n)
        s(i, k): how well item k would represent item i; the diagonal is ignored.
        ``-inf`` forbids a pair.
    preference : float or ndarray of shape (n,)
        Finite self-similarities; more of it, more clusters.
    params : AffinityParams
        Damping, limits and the seed of the jitter.

    Returns
    -------
    Clustering
        ``n_iter`` counts the iterations of all runs; ``damping`` is that of the last one.

    Raises
    ------
    ValueError
        If the shapes do not fit, a similarity is NaN or +inf, or a preference not finite.

    Notes
    -----
    A run ends when the exemplars have not changed for ``convergence_iter`` iterations
    (the net similarity, which the paper watches, is then constant too). A run that ends
    otherwise is repeated with more damping; if none converges, the exemplars with the
    best net similarity among all that were seen are taken, and if there never was any,
    the item with the largest column sum. Once, at the end, the exemplar of a cluster
    becomes the member that represents the others best. An item that may not go to any
    exemplar becomes one.

    Ties are broken by jitter. Of items that equal one another in every respect only the
    first may become an exemplar, if one of them can stand in for the others at no loss.
    Otherwise iterations and result are those of scikit-learn with ``random_state=seed``.

    Beside its input it takes 3 n^2 floats: the similarities with jitter and the two
    kinds of message.

    Examples
    --------
    >>> x = np.array([0.0, 0.1, 0.2, 5.0, 5.1, 5.2])
    >>> result = affinity_propagation(-(x[:, None] - x) ** 2, -1.0, AffinityParams())
    >>> result.exemplars.tolist(), result.labels.tolist()
    ([1, 4], [0, 0, 0, 1, 1, 1])
    """
    preferences = _checked(similarities, preference)
    exemplars = _closed_form(similarities, preferences)
    run = Run(None, 0, converged=True, damping=params.damping)
    if exemplars is None:
        s = _without_ties(similarities, preferences, params.seed)
        run = run_until_converged(s, params)
        exemplars = _refined(s, _serving_all(s, _exemplars_of(run, s)))
    labels = _assign(similarities, exemplars)
    mean = float(preferences.mean()) if preferences.size else 0.0
    return Clustering(
        exemplars=exemplars,
        labels=labels,
        n_iter=run.n_iter,
        converged=run.converged,
        damping=run.damping,
        net_similarity=_net_similarity(similarities, preferences, exemplars, labels),
        preference=mean,
    )


def jittered(similarities: Float64Array, seed: int) -> Float64Array:
    """Return a copy with seeded noise in the last digits, which breaks exact ties.

    The noise is (eps s + 100 tiny) N(0, 1) on every entry, the diagonal included, as in
    Frey and Dueck's program; ``-inf`` stays. It is bit for bit what scikit-learn adds for
    the same ``random_state``.

    Examples
    --------
    >>> s = jittered(np.full((2, 2), -1.0), seed=0)
    >>> len(np.unique(s)) > 1, bool(np.allclose(s, -1.0))
    (True, True)
    """
    s = np.array(similarities, dtype=np.float64, order="C")
    _add_jitter(s, seed)
    return s


def weighted_similarities(
    similarities: Float64Array,
    counts: IntArray,
    preference: float,
    distortions: Float64Array | None = None,
) -> tuple[Float64Array, Float64Array]:
    """Similarities of items that stand for several points each (section 3.3).

    Parameters
    ----------
    similarities : ndarray of shape (n, n)
        Similarities of the items; the diagonal is ignored.
    counts : ndarray of shape (n,)
        How many points each item stands for, 1 or more.
    preference : float
        Preference of one point.
    distortions : ndarray of shape (n,), optional
        Sum of -s(point, item) over the points of each item; zeros if left out.

    Returns
    -------
    tuple of ndarray of shape (n, n) and (n,)
        Similarities n_i s(i, k) with the preferences on their diagonal, and these
        preferences p - distortion.

    Notes
    -----
    For duplicates the net similarity of the items is exactly that of all points, so the
    preference has the scale of the points, not of the items.
    """
    weighted = np.multiply(np.asarray(counts, np.float64)[:, None], similarities)
    diagonal = np.full(len(weighted), preference, np.float64)
    if distortions is not None:
        diagonal -= distortions
    np.fill_diagonal(weighted, diagonal)
    return weighted, diagonal


def _checked(similarities: Float64Array, preference: float | Float64Array) -> Float64Array:
    """Return the preferences as a vector, or say what is wrong with the input."""
    n = len(similarities)
    if similarities.shape != (n, n):
        msg = f"similarities: found shape {similarities.shape}, expected a square matrix"
        raise ValueError(msg)
    bad = np.isnan(similarities) | (similarities == np.inf)
    np.fill_diagonal(bad, val=False)
    if bad.any():
        msg = f"similarities: {np.count_nonzero(bad)} of {n * n} are NaN or +inf"
        raise ValueError(msg)
    preferences = np.asarray(preference, np.float64)
    if preferences.shape not in {(), (n,)} or not np.isfinite(preferences).all():
        msg = f"preference: expected one or {n} finite numbers, found {preference}"
        raise ValueError(msg)
    return np.broadcast_to(preferences, (n,)).copy()


def _closed_form(s: Float64Array, p: Float64Array) -> IntArray | None:
    """Return the exemplars where no messages are needed (or none could decide), else None."""
    n = len(p)
    if n <= 1:
        return np.arange(n)
    if n == 2:  # noqa: PLR2004
        # max takes the first of equals: fewer clusters, then the lower index
        values = {(0,): p[0] + s[1, 0], (1,): p[1] + s[0, 1], (0, 1): p[0] + p[1]}
        return np.array(max(values, key=lambda chosen: values[chosen]))
    value = s[0, 1]
    n_equal = np.count_nonzero(s == value) - np.count_nonzero(np.diagonal(s) == value)
    if n_equal < n * (n - 1) or (p != p[0]).any():
        return None
    return np.arange(n) if p[0] > value else np.zeros(1, np.int64)


def _without_ties(s: Float64Array, p: Float64Array, seed: int) -> Float64Array:
    """Return a copy with the preferences on its diagonal and no equals among exemplars."""
    is_later = _later_copies(s, p)
    s = np.array(s, dtype=np.float64, order="C")
    np.fill_diagonal(s, p)
    _add_jitter(s, seed)
    if is_later.any():
        # the jitter of copies can be lost in rounding, and then they block one another
        s[is_later, is_later] -= np.ptp(s[np.isfinite(s)])
    return s


def _add_jitter(s: Float64Array, seed: int) -> None:
    """Add the noise of :func:`jittered` in place, a row at a time to save memory."""
    rng = np.random.RandomState(seed)  # what scikit-learn uses
    real = np.finfo(np.float64)
    for row in s:
        noise = rng.standard_normal(len(row))
        noise *= real.eps * np.where(np.isinf(row), 0.0, row) + 100 * real.tiny
        np.add(row, noise, out=row)


def _later_copies(s: Float64Array, p: Float64Array) -> BoolArray:
    """Tell which items equal an earlier one in every respect and could stand in for it."""
    first_of: dict[bytes, int] = {}
    is_later = np.zeros(len(p), np.bool_)
    for i in range(len(p)):
        # with the nearest similarity on the diagonal, the rows of copies are equal
        row = s[i] + 0.0
        row[i] = -np.inf
        row[i] = row.max()
        first = first_of.setdefault(row.tobytes(), i)
        if first < i and p[first] == p[i] <= row[i]:
            differs = s[:, first] != s[:, i]
            is_later[i] = not np.delete(differs, [first, i]).any()
    return is_later


def _exemplars_of(run: Run, s: Float64Array) -> IntArray:
    if run.best is None:
        return np.array([s.sum(axis=0).argmax()])
    return run.best.exemplars


def _serving_all(s: Float64Array, exemplars: IntArray) -> IntArray:
    """Add items as exemplars, lowest first, until every item has one that it may go to."""
    served = s[:, exemplars].max(axis=1) > -np.inf
    added = []
    while not served.all():
        added.append(int(served.argmin()))
        served |= s[:, added[-1]] > -np.inf
    return np.union1d(exemplars, np.array(added, np.int64))


def _refined(s: Float64Array, exemplars: IntArray) -> IntArray:
    """Move each exemplar to the member of its cluster that has the largest sum."""
    labels = _assign(s, exemplars)
    refined = []
    for cluster in range(len(exemplars)):
        members = np.flatnonzero(labels == cluster)
        sums = s[np.ix_(members, members)].sum(axis=0)
        refined.append(members[sums.argmax()])
    return np.sort(np.array(refined, np.int64))


def _assign(s: Float64Array, exemplars: IntArray) -> IntArray:
    """Return the position of each item's exemplar; the lowest of equals."""
    if not exemplars.size:
        return np.zeros(0, np.int64)
    labels: IntArray = s[:, exemplars].argmax(axis=1)
    labels[exemplars] = np.arange(exemplars.size)
    return labels


def _net_similarity(
    s: Float64Array, p: Float64Array, exemplars: IntArray, labels: IntArray
) -> float:
    """Sum of s(i, c_i), where an exemplar counts its preference (equation 2)."""
    values = s[np.arange(len(labels)), exemplars[labels]].astype(np.float64)
    values[exemplars] = p[exemplars]
    return float(values.sum())
