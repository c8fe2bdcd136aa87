"""Algorithm 2 one observation after the other, with plain lists and full matrices."""

from dataclasses import dataclass, field

import numpy as np

from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.observations import Float32Array, Float64Array, IntArray
from mpap_cli.params import AffinityParams, StrapParams


@dataclass(eq=False)
class Item:
    """A cluster, or an outlier that stands for itself."""

    id: int
    exemplar: Float32Array
    source: tuple[int, int, int]
    first_ns: int
    last_ns: int
    faded_ns: int
    count: int = 1
    weight: float = 1.0
    distortion: float = 0.0
    labels: list[int] = field(default_factory=lambda: [0, 0])


def squared_distance(u: Float32Array, v: Float32Array) -> float:
    """Half of the squared differences, summed from the first to the last in float64."""
    total = 0.0
    for x, y in zip(u.tolist(), v.tolist(), strict=True):
        total += (x - y) * (x - y)
    return 0.5 * total


def table(items: list[Item], others: list[Item]) -> Float64Array:
    """Squared distances of all pairs."""
    rows = [[squared_distance(i.exemplar, k.exemplar) for k in others] for i in items]
    return np.array(rows, np.float64).reshape(len(items), len(others))


class Reference:
    """The pseudo-code of sections 3.3 and 4.2.4."""

    def __init__(self, strap: StrapParams, affinity: AffinityParams) -> None:
        self.strap, self.affinity = strap, affinity
        self.clusters: list[Item] = []
        self.outliers: list[Item] = []
        self.heir: dict[int, int] = {}
        self.n_since_rebuild = self.n_rebuilds = 0
        self.share_of = [0.0, 0.0, 0.0, 0.0]
        self.surplus = [0.0, 0.0]

    def add_observation(
        self, z: Float32Array, stamp_ns: int, patch: int, log_index: int
    ) -> tuple[int, float, bool]:
        """Return id, squared distance, and whether it is an outlier."""
        self.n_since_rebuild += 1
        squared = [squared_distance(z, cluster.exemplar) for cluster in self.clusters]
        nearest = min(squared, default=np.inf)
        is_outlier = not nearest < self.strap.eps**2
        if is_outlier:
            new = Item(
                len(self.heir), z, (stamp_ns, log_index, patch), stamp_ns, stamp_ns, stamp_ns
            )
            self.heir[new.id] = new.id
            self.outliers.append(new)
            found = new.id
        else:
            cluster = self.clusters[squared.index(nearest)]
            self.fit(cluster, nearest, stamp_ns)
            found = cluster.id
        risen, overflows = self.has_risen(is_outlier), self.overflows(is_outlier)
        if risen or overflows:
            self.rebuild()
        elif len(self.outliers) > self.strap.reservoir:
            self.settle(self.outliers.pop(0))
        return found, nearest, is_outlier

    def fit(self, cluster: Item, squared: float, now: int) -> None:
        """Update a cluster with an observation."""
        n, window_s = cluster.weight, self.strap.strap_window_s
        cluster.weight, added, g = n + 1, squared, 1.0
        if window_s is not None:
            g = window_s * 1e9 / (window_s * 1e9 + max(0, now - cluster.faded_ns))
            cluster.weight, added = n * (g + 1 / (n + 1)), n / (n + 1) * squared
        cluster.distortion = g * cluster.distortion + added
        cluster.count += 1
        cluster.last_ns = cluster.faded_ns = now

    def has_risen(self, is_outlier: bool) -> bool:
        """Page-Hinkley."""
        n, total, m, least = self.share_of
        n, total = n + 1, total + is_outlier
        m += is_outlier - total / n - self.strap.page_hinkley_delta
        least = min(least, m)
        self.share_of = [n, total, m, least]
        return self.strap.page_hinkley and m - least > self.strap.page_hinkley_lambda

    def overflows(self, is_outlier: bool) -> bool:
        """Too many outliers since the last rebuild, or in a stretch of a known place."""
        most, known = self.strap.reservoir, self.strap.known_share
        if not known or self.n_since_rebuild <= int(most / known) + 1:
            return len(self.outliers) > most
        m, least = self.surplus
        m += is_outlier - self.strap.noise_share
        least = min(least, m)
        self.surplus = [m, least]
        return m - least > most

    def settle(self, outlier: Item) -> None:
        """Let the nearest cluster count an outlier that left the reservoir."""
        nearest = self.clusters[int(table([outlier], self.clusters).argmin())]
        nearest.count += 1
        nearest.labels = [a + b for a, b in zip(nearest.labels, outlier.labels, strict=True)]
        self.heir[outlier.id] = nearest.id

    def short_exemplars(self) -> list[int]:
        """Affinity propagation over the outliers."""
        s = -table(self.outliers, self.outliers)
        return list(affinity_propagation(s, median(s), self.affinity).exemplars)

    def rebuild(self) -> None:
        """Lines 6 to 8."""
        items, k = self.faded(), len(self.clusters)
        rows = list(range(k, len(items)))
        must = [*range(k), *(k + row for row in self.short_exemplars())]
        squared, eps = table(items, items), self.strap.eps
        exemplars = list(range(k))
        if rows:
            exemplars = self.exemplars_of(items, rows)
            for row in sorted(must, key=lambda row: (-items[row].count, row)):
                if row not in exemplars and not (squared[row, exemplars] < eps * eps).any():
                    exemplars = sorted([*exemplars, row])
        if items:
            labels = squared[:, exemplars].argmin(axis=1)
            labels[exemplars] = range(len(exemplars))
            self.clusters = self.made(items, exemplars, labels, squared)
        self.outliers = []
        self.n_since_rebuild = 0
        self.n_rebuilds += 1
        self.share_of = [0.0, 0.0, 0.0, 0.0]
        self.surplus = [0.0, 0.0]

    def exemplars_of(self, items: list[Item], outliers: list[int]) -> list[int]:
        """Weighted affinity propagation over the outliers and the clusters near them."""
        eps, k = self.strap.eps, len(self.clusters)
        squared = table(items, items)
        close = squared[:k, :k] + np.where(np.eye(k), np.inf, 0.0) < eps * eps
        involved = (squared[:k][:, outliers] < (2 * eps) ** 2).any(axis=1) | close.any(axis=1)
        rows = [*np.flatnonzero(involved).tolist(), *outliers]
        weights = np.array([min(items[row].weight, self.strap.weight_cap) for row in rows])
        s = -squared[np.ix_(rows, rows)]
        step = -(-len(items) // 1000)
        p = np.full(len(rows), median(-squared[::step, ::step]))
        if self.strap.strap_distortion:
            share = self.strap.weight_cap / np.array(
                [max(items[row].weight, self.strap.weight_cap) for row in rows]
            )
            p -= share * [items[row].distortion for row in rows]
        found = affinity_propagation(weights[:, None] * s, p, self.affinity)
        return sorted({rows[e] for e in found.exemplars} | set(np.flatnonzero(~involved).tolist()))

    def faded(self) -> list[Item]:
        """Clusters and outliers as they weigh now."""
        items = [*self.clusters, *self.outliers]
        window_s = self.strap.strap_window_s
        now = max((item.faded_ns for item in items), default=0)
        if window_s is None:
            return items
        for item in items:
            g = window_s * 1e9 / (window_s * 1e9 + (now - item.faded_ns))
            item.weight, item.distortion, item.faded_ns = g * item.weight, g * item.distortion, now
        return items

    def made(
        self, items: list[Item], exemplars: list[int], labels: IntArray, squared: Float64Array
    ) -> list[Item]:
        """Sum up what goes to each exemplar."""
        clusters = []
        for label, row in enumerate(exemplars):
            members = [i for i in range(len(items)) if labels[i] == label]
            parts = [items[i] for i in members]
            new = Item(
                id=min(parts, key=lambda part: (-part.count, part.id)).id,
                exemplar=items[row].exemplar,
                source=items[row].source,
                first_ns=min(part.first_ns for part in parts),
                last_ns=max(part.last_ns for part in parts),
                faded_ns=max(part.faded_ns for part in parts),
                count=sum(part.count for part in parts),
                weight=0.0,
                labels=[sum(part.labels[column] for part in parts) for column in (0, 1)],
            )
            for i in members:
                new.weight += items[i].weight
                new.distortion += items[i].distortion + items[i].weight * squared[i, row]
            for part in parts:
                self.heir[part.id] = new.id
            clusters.append(new)
        return sorted(clusters, key=lambda cluster: cluster.id)

    def current(self, found: int) -> int:
        """Return what became of an id."""
        while self.heir[found] != found:
            found = self.heir[found]
        return found

    def add_label(self, found: int, positive: bool) -> None:
        """Count a label where the observation is now."""
        current = self.current(found)
        for item in [*self.clusters, *self.outliers]:
            if item.id == current:
                item.labels[int(positive)] += 1


def median(s: Float64Array) -> float:
    """Median beside the diagonal, 0 without any pair."""
    beside = s[~np.eye(len(s), dtype=bool)]
    return float(np.quantile(beside, 0.5)) if beside.size else 0.0
