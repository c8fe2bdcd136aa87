"""Profile robust learnt by a straightforward script: one message at a time.

rosbags deserializes every message, numpy works on one scan at a time, Algorithm 1 of the
paper is a loop over arrays, scikit-learn clusters the cluster-points. The peer of ``mpap
learn``: the same operators, for a log with topics /scan and /bumper (std_msgs/Bool) whose
scanner looks ahead.
"""

import sys
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.highlevel import AnyReader
from sklearn.cluster import AffinityPropagation

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
BINS, THETA, MIN_POINTS = 12, 0.08, 2
FLOOR_M, CAP_M, AHEAD_CAP_M, STEP_M = 0.2, 1.0, 2.0, 0.5
SECOND_NS = 10**9
LOOKBACK_NS, APPROACH_NS = SECOND_NS, 6 * SECOND_NS // 10
ONSET_NS, RELEASE_NS, EARLY_NS = SECOND_NS, SECOND_NS, SECOND_NS
RING_WEIGHT, SECTOR_WEIGHT, APPROACH_WEIGHT = np.sqrt(np.array([1.0, 0.5, 0.3]) / 1.8)


@dataclass(frozen=True)
class Learnt:
    """How large the model became; ``labels`` (3, 2): contact, onset, early; free, pressed."""

    n_scans: int
    n_meta_points: int
    n_cluster_points: int
    n_clusters: int
    labels: tuple[tuple[int, int], ...]


def embed(histogram: Array) -> Array:
    """Return the square root of a histogram of unit mass, with the coordinate of the empty one."""
    point = np.zeros(len(histogram) + 1)
    mass = histogram.sum()
    if mass <= 1e-12:  # noqa: PLR2004  # as equation 7 is read
        point[-1] = 1.0
    else:
        point[:-1] = np.sqrt(histogram / mass)
    return point


class Features:
    """Scan to feature; the last second of scans is kept."""

    def __init__(self) -> None:
        self.geometry: tuple[float, float, int] | None = None
        self.minima: deque[tuple[int, Array]] = deque()
        self.ahead: deque[tuple[int, float]] = deque()

    def look(self, geometry: tuple[float, float, int]) -> None:
        """Find the sector of every beam, and which beams look ahead."""
        angle_min, increment, n_beams = geometry
        angles = angle_min + increment * np.arange(n_beams)
        tolerance = 1e-3 * abs(increment)
        turned = np.mod(angles + np.pi + tolerance, 2 * np.pi)
        self.sector = np.floor(turned / (2 * np.pi / BINS)).astype(int)
        self.is_ahead = np.abs(turned - tolerance - np.pi) <= np.pi / 2 + tolerance
        self.geometry = geometry

    def __call__(self, stamp_ns: int, message: Any) -> NDArray[np.float32]:
        """Return the embedded feature of one scan."""
        geometry = (message.angle_min, message.angle_increment, len(message.ranges))
        if geometry != self.geometry:
            self.look(geometry)
        cleaned = self.clean(message)
        minima = np.full(BINS, float(message.range_max))
        np.minimum.at(minima, self.sector, cleaned)
        self.minima.append((stamp_ns, minima))
        while self.minima[0][0] < stamp_ns - LOOKBACK_NS:
            self.minima.popleft()
        lowest = np.min([values for _, values in self.minima], axis=0)
        near = 1.0 / np.clip(lowest, FLOOR_M, CAP_M)
        ring = np.array([near.max(), 1.0 / FLOOR_M - near.max()])
        sectors = np.append(near, max(BINS / FLOOR_M - near.sum(), 0.0))
        step = self.approach(stamp_ns, min(float(cleaned[self.is_ahead].min()), AHEAD_CAP_M))
        moves = np.array([max(step, 0.0), max(-step, 0.0), STEP_M - abs(step)])
        blocks = (
            RING_WEIGHT * embed(ring),
            SECTOR_WEIGHT * embed(sectors),
            APPROACH_WEIGHT * embed(moves),
        )
        return np.concatenate(blocks).astype(np.float32)

    def clean(self, message: Any) -> NDArray[np.float32]:
        """Replace what is no range: no return is range_max, too near is range_min."""
        ranges, low, high = message.ranges, message.range_min, message.range_max
        cleaned = np.where(np.isfinite(ranges) & (ranges > 0) & (ranges <= high), ranges, high)
        cleaned[ranges == -np.inf] = low
        raised: NDArray[np.float32] = np.maximum(cleaned, low)
        return raised

    def approach(self, stamp_ns: int, ahead: float) -> float:
        """Return the change of the nearest range ahead, against the scan 0.6 s before."""
        target_ns = stamp_ns - APPROACH_NS
        self.ahead.append((stamp_ns, ahead))
        while len(self.ahead) > 1 and self.ahead[1][0] <= target_ns:
            self.ahead.popleft()
        before = min(self.ahead, key=lambda one: abs(one[0] - target_ns))[1]
        return min(max(ahead - before, -STEP_M), STEP_M)


class MetaPoints:
    """Algorithm 1 with one array row per meta-point."""

    def __init__(self, theta: float = THETA) -> None:
        self.theta = theta
        self.sums: list[Array] = []
        self.counts: list[int] = []
        self.exemplars: list[Array] = []
        self.rows: dict[bool, list[int]] = {True: [], False: []}
        self.means: dict[bool, Array] = {}

    def nearest(self, point: Array, of_cluster: bool) -> tuple[int, float]:
        """Return the place of the nearest cluster-point or noise-point, and its distance."""
        if not self.rows[of_cluster]:
            return -1, np.inf
        squared = ((self.means[of_cluster] - point) ** 2).sum(axis=1)
        place = int(squared.argmin())
        return place, float(np.sqrt(0.5 * squared[place]))

    def update(self, place: int, point: Array, of_cluster: bool) -> int:
        """Let a meta-point take in a point; return its row."""
        row = self.rows[of_cluster][place]
        self.counts[row] += 1
        self.sums[row] += point
        self.means[of_cluster][place] = self.sums[row] / np.linalg.norm(self.sums[row])
        return row

    def append(self, row: int, of_cluster: bool) -> None:
        """Put a meta-point on the list of the cluster-points or of the noise-points."""
        mean = (self.sums[row] / np.linalg.norm(self.sums[row]))[None]
        known = self.means.get(of_cluster)
        self.means[of_cluster] = mean if known is None else np.vstack([known, mean])
        self.rows[of_cluster].append(row)

    def add_data_point(self, point: Array) -> int:
        """Return the row of the meta-point that takes the point in."""
        place, distance = self.nearest(point, of_cluster=True)
        if distance < self.theta:
            return self.update(place, point, of_cluster=True)
        place, distance = self.nearest(point, of_cluster=False)
        if distance < self.theta:
            row = self.update(place, point, of_cluster=False)
            if self.counts[row] >= MIN_POINTS:
                self.rows[False].pop(place)
                self.means[False] = np.delete(self.means[False], place, axis=0)
                self.append(row, of_cluster=True)
            return row
        self.sums.append(point.copy())
        self.counts.append(1)
        self.exemplars.append(point)
        self.append(len(self.sums) - 1, of_cluster=False)
        return len(self.sums) - 1


def count_labels(stamps_ns: Ints, rows: Ints, presses: list[list[int]], n_rows: int) -> Ints:
    """Count labels by meta-point: (n_rows, 3, 2), contact, onset, early; free, pressed."""
    labels = np.zeros((3, len(stamps_ns)), dtype=np.int64)
    for start_ns, _ in presses:
        labels[2, (stamps_ns >= start_ns - EARLY_NS) & (stamps_ns < start_ns)] = 1
    for start_ns, end_ns in presses:
        pressed = (stamps_ns >= start_ns) & (stamps_ns < end_ns)
        labels[0, pressed] = 1
        labels[1, (stamps_ns >= start_ns) & (stamps_ns < end_ns + RELEASE_NS)] = -1
        labels[1, pressed & (stamps_ns < start_ns + ONSET_NS)] = 1
        labels[2, pressed] = -1
    counts = np.zeros((n_rows, 3, 2), dtype=np.int64)
    for pair in range(3):
        counted = labels[pair] >= 0
        np.add.at(counts, (rows[counted], pair, labels[pair][counted]), 1)
    return counts


def cluster(points: Array) -> int:
    """Cluster the exemplars of the cluster-points; return the number of clusters."""
    similarities = -0.5 * ((points[:, None] - points[None]) ** 2).sum(axis=2)
    off_diagonal = similarities[~np.eye(len(points), dtype=bool)]
    model = AffinityPropagation(
        affinity="precomputed",
        damping=0.9,
        max_iter=1000,
        convergence_iter=50,
        preference=float(np.quantile(off_diagonal, 0.9)),
        random_state=0,
    )
    return len(model.fit(similarities).cluster_centers_indices_)


def main(path: Path) -> Learnt:
    """Learn from one log."""
    features, meta_points = Features(), MetaPoints()
    stamps_ns: list[int] = []
    rows: list[int] = []
    presses: list[list[int]] = []
    is_pressed = False
    with AnyReader([path]) as reader:
        chosen = [one for one in reader.connections if one.topic in {"/scan", "/bumper"}]
        for connection, stamp_ns, raw in reader.messages(connections=chosen):
            message: Any = reader.deserialize(raw, connection.msgtype)
            if connection.topic == "/scan":
                point = features(stamp_ns, message).astype(np.float64)
                rows.append(meta_points.add_data_point(point))
                stamps_ns.append(stamp_ns)
            elif message.data and not is_pressed:
                presses.append([stamp_ns, sys.maxsize])
            elif is_pressed and not message.data:
                presses[-1][1] = stamp_ns
            if connection.topic == "/bumper":
                is_pressed = bool(message.data)
    counts = count_labels(np.array(stamps_ns), np.array(rows), presses, len(meta_points.sums))
    exemplars = np.array([meta_points.exemplars[row] for row in meta_points.rows[True]])
    return Learnt(
        n_scans=len(rows),
        n_meta_points=len(meta_points.sums),
        n_cluster_points=len(exemplars),
        n_clusters=cluster(exemplars),
        labels=tuple((int(free), int(pressed)) for free, pressed in counts.sum(axis=0)),
    )


if __name__ == "__main__":
    print(main(Path(sys.argv[1])))
