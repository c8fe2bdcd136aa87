"""Algorithm 1 as the paper prints it, one Python object a meta-point, without any haste."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from mpap_cli.observations import Float32Array
from mpap_cli.params import MetaPointParams


@dataclass(eq=False)
class MetaPoint:
    """The fields of section 3.4."""

    id: int
    first_ns: int
    sums: list[float]
    exemplar: list[float]
    exemplar_stamp_ns: int
    exemplar_log: int
    count: int = 0
    last_ns: int = 0
    reference: list[float] = field(default_factory=list)


def squared_distance(u: Sequence[float], v: Sequence[float]) -> float:
    """Sum in four strands, the coordinates behind the last four in the first strand."""
    strands = [0.0] * 4
    whole = len(u) - len(u) % 4
    for j, (x, y) in enumerate(zip(u, v, strict=True)):
        strands[j % 4 if j < whole else 0] += (x - y) * (x - y)
    return (strands[0] + strands[1]) + (strands[2] + strands[3])


class Reference:
    """Two plain lists of meta-points and the pseudo-code."""

    def __init__(self, params: MetaPointParams, *, normalized: bool) -> None:
        self.params = params
        self.normalized = normalized
        self.cluster_points: list[MetaPoint] = []
        self.noise_points: list[MetaPoint] = []
        self.n_made = 0
        self.n_dropped = 0

    def add_data_point(
        self, features: Float32Array, stamp_ns: int, log_index: int = 0
    ) -> tuple[int, int]:
        """Return the id of the meta-point that took the point, and the case."""
        p = [float(x) for x in features]
        self.forget(stamp_ns)
        case = 1
        nn = self.nearest_neighbor(self.cluster_points, p)
        if nn is None:
            case = 2
            nn = self.nearest_neighbor(self.noise_points, p)
        if nn is None:
            case = 3
            nn = MetaPoint(self.n_made, stamp_ns, [0.0] * len(p), p, stamp_ns, log_index)
            self.n_made += 1
            self.noise_points.append(nn)
        self.update_meta_point(nn, p, stamp_ns, log_index)
        if case > 1 and nn.count >= self.params.min_points:
            self.noise_points.remove(nn)
            self.cluster_points.append(nn)
        while len(self.noise_points) > self.params.max_noise:
            self.drop(min(self.noise_points, key=lambda n: (n.count > 1, n.last_ns, n.id)))
        return nn.id, case

    def forget(self, now_ns: int) -> None:
        """Drop the noise-points that nobody has seen for the time to live."""
        if self.params.noise_ttl is not None:
            ttl_ns = round(self.params.noise_ttl * 1e9)
            for old in [n for n in self.noise_points if now_ns - n.last_ns > ttl_ns]:
                self.drop(old)

    def drop(self, old: MetaPoint) -> None:
        """Forget a noise-point."""
        self.noise_points.remove(old)
        self.n_dropped += 1

    def nearest_neighbor(self, among: list[MetaPoint], p: list[float]) -> MetaPoint | None:
        """Return the nearest one if it is within theta; the oldest of equals."""
        factor = 0.5 if self.normalized else 1.0
        nearest = min(among, key=lambda n: (squared_distance(p, n.reference), n.id), default=None)
        theta = self.params.theta
        if nearest and factor * squared_distance(p, nearest.reference) < theta * theta:
            return nearest
        return None

    def update_meta_point(
        self, nn: MetaPoint, p: list[float], stamp_ns: int, log_index: int
    ) -> None:
        """Recompute the statistics with one more point."""
        nn.count += 1
        nn.last_ns = stamp_ns
        nn.sums = [total + x for total, x in zip(nn.sums, p, strict=True)]
        divisor = math.sqrt(squared_distance([0.0] * len(p), nn.sums))
        if not self.normalized or divisor == 0:
            divisor = nn.count
        mean = [total / divisor for total in nn.sums]
        nearer = squared_distance(p, mean) < squared_distance(nn.exemplar, mean)
        if self.params.exemplar == "closest" and nearer:
            nn.exemplar, nn.exemplar_stamp_ns, nn.exemplar_log = p, stamp_ns, log_index
        nn.reference = mean if self.params.reference == "mean" else nn.exemplar

    def table(self) -> dict[str, np.ndarray]:
        """Return all meta-points by age, as the arrays of MetaPoints."""
        rows = sorted(self.cluster_points + self.noise_points, key=lambda n: n.id)
        return {
            "ids": np.array([n.id for n in rows], np.int64),
            "count": np.array([n.count for n in rows], np.int64),
            "first_ns": np.array([n.first_ns for n in rows], np.int64),
            "last_ns": np.array([n.last_ns for n in rows], np.int64),
            "exemplar_stamp_ns": np.array([n.exemplar_stamp_ns for n in rows], np.int64),
            "exemplar_log": np.array([n.exemplar_log for n in rows], np.int64),
            "sums": np.array([n.sums for n in rows], np.float64),
            "exemplars": np.array([n.exemplar for n in rows], np.float32),
            "is_cluster_point": np.array([n in self.cluster_points for n in rows], np.bool_),
        }
