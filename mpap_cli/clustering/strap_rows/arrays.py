"""Clusters and outliers of STRAP as arrays with one row each (section 3.3)."""

from typing import NamedTuple

import numpy as np

from mpap_cli.observations import NS_PER_S, Float32Array, Float64Array, IntArray


class Items(NamedTuple):
    """Clusters, or outliers that each stand for themselves; the first axis is the item.

    The paper's tuple (e, n, Sigma, t) is ``exemplars``, ``weight``, ``distortion`` and
    ``last_ns``. ``weight`` is n as the window fades it, brought up to date at ``faded_ns``;
    ``counts`` is how many observations there ever were. ``labels`` (n, 2) counts the negative
    and the positive ones. Where an exemplar comes from, stamp, log and patch, tells where to
    find its picture.
    """

    ids: IntArray
    counts: IntArray
    first_ns: IntArray
    last_ns: IntArray
    faded_ns: IntArray
    exemplar_stamp_ns: IntArray
    exemplar_log: IntArray
    exemplar_patch: IntArray
    labels: IntArray
    weight: Float64Array
    distortion: Float64Array
    exemplars: Float32Array

    @property
    def n_items(self) -> int:
        """Number of rows."""
        return len(self.ids)


COLUMNS = {
    **dict.fromkeys(Items._fields, "i8"),
    "weight": "f8",
    "distortion": "f8",
    "exemplars": "f4",
}


def empty_items(n: int, n_dims: int) -> Items:
    """Return n rows of zeros."""
    shapes = {"labels": (n, 2), "exemplars": (n, n_dims)}
    return Items._make(np.zeros(shapes.get(name, (n,)), kind) for name, kind in COLUMNS.items())


def single_items(
    features: Float32Array, ids: IntArray, stamps_ns: IntArray, patches: IntArray, log_index: int
) -> Items:
    """Return items that each stand for one observation."""
    items = empty_items(*features.shape)
    items.exemplars[:], items.ids[:], items.exemplar_patch[:] = features, ids, patches
    items.exemplar_log[:], items.counts[:], items.weight[:] = log_index, 1, 1.0
    for stamps in (items.first_ns, items.last_ns, items.faded_ns, items.exemplar_stamp_ns):
        stamps[:] = stamps_ns
    return items


def taken(items: Items, rows: IntArray | slice) -> Items:
    """Copy some of the rows."""
    return Items._make(np.array(column[rows]) for column in items)


def joined(first: Items, second: Items) -> Items:
    """Return the rows of one and then those of the other."""
    return Items._make(
        np.concatenate([getattr(first, name), getattr(second, name)]) for name in Items._fields
    )


def faded(items: Items, window_s: float | None) -> Items:
    """Return the items with what they weigh at the last stamp of them all.

    A share g = window / (window + time since) of weight and distortion is left; without a
    window nothing fades.
    """
    if window_s is None or not items.n_items:
        return items
    now = items.faded_ns.max()
    window_ns = NS_PER_S * window_s
    share = window_ns / (window_ns + (now - items.faded_ns))
    return items._replace(
        weight=share * items.weight,
        distortion=share * items.distortion,
        faded_ns=np.full_like(items.faded_ns, now),
    )


def absorbed(items: Items, exemplars: IntArray, labels: IntArray, squared: Float64Array) -> Items:
    """Make one cluster of all items that go to the same exemplar (section 3.3).

    Parameters
    ----------
    items : Items
        n clusters and outliers, ids ascending.
    exemplars : ndarray of shape (k,)
        Which of them are exemplars.
    labels : ndarray of shape (n,)
        Indices into ``exemplars``, one of each item.
    squared : ndarray of shape (n,)
        Squared distance of each item to its exemplar.

    Returns
    -------
    Items
        k clusters, in the order of ``exemplars``. Counts, weights and labels are sums; the
        distortion also has what moving each item to its new exemplar adds. A cluster has
        the id of the heaviest item that it is made of, the first of equals.
    """
    made = taken(items, exemplars)
    for name in ("counts", "weight", "distortion", "labels"):
        getattr(made, name)[:] = 0
    np.add.at(made.counts, labels, items.counts)
    np.add.at(made.weight, labels, items.weight)
    np.add.at(made.distortion, labels, items.distortion + items.weight * squared)
    np.add.at(made.labels, labels, items.labels)
    np.minimum.at(made.first_ns, labels, items.first_ns)
    np.maximum.at(made.last_ns, labels, items.last_ns)
    np.maximum.at(made.faded_ns, labels, items.faded_ns)
    by_weight = np.lexsort((np.arange(items.n_items), -items.counts, labels))
    heaviest = by_weight[np.searchsorted(labels[by_weight], np.arange(len(exemplars)))]
    made.ids[:] = items.ids[heaviest]
    return made
