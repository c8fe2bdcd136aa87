"""Merged against one history: ``python benchmarks/scores/merging.py [LOG...]``.

Labelled streams of eight logs: V-measure of meta-points that met one log after the other, in
two orders, and of eight leaves merged. With LOGs: scores of the model that ``learn`` makes of
them and of the one of ``learn --merge``, by ``evaluate --model`` on the same logs.
"""

import argparse
import csv
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from sklearn.metrics import v_measure_score

from benchmarks.measuring.processes import MPAP, environment
from mpap_cli.clustering.merging import merge_meta_points
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.distance import embed, squared_distances
from mpap_cli.observations import Float32Array, IntArray
from mpap_cli.params import AffinityParams, MetaPointParams

N_LOGS = 8
OTHER_ORDER = (3, 7, 1, 5, 0, 2, 6, 4)
TARGETS = ("contact", "early:1")
_N_POINTS = 300
_N_CLASSES = 10
_PAUSE = 1000
_LOOSE = 150.0
_COLUMNS = """V of eight logs met in turn, in another order, and merged; differences to the first
stream      preference    in turn  other    merged     merged   from ..  to      other"""


class Part(NamedTuple):
    """The points (n, d) of one log, and the class (n,) of each."""

    points: Float32Array
    classes: IntArray


class Stream(NamedTuple):
    """Eight logs, and the radius that fits them."""

    logs: list[Part]
    theta: float
    normalized: bool


def histograms(seed: int) -> Stream:
    """Draw histograms of ten classes; every other log sees half of them only."""
    rng = np.random.default_rng(seed)
    centers = rng.dirichlet(np.full(12, 0.5), _N_CLASSES)
    logs = []
    for log in range(N_LOGS):
        classes = rng.integers(_N_CLASSES // (1 + log % 2), size=_N_POINTS)
        drawn = rng.standard_gamma(_LOOSE * centers[classes] + 1e-3)
        logs.append(Part(embed(drawn.astype(np.float32)).astype(np.float32), classes))
    return Stream(logs, 0.1, normalized=True)


def plane(seed: int) -> Stream:
    """Draw points around ten places in the plane."""
    rng = np.random.default_rng(seed)
    places = np.array([(10.0 * x, 10.0 * y) for y in range(3) for x in range(4)])[:_N_CLASSES]
    logs = []
    for _ in range(N_LOGS):
        classes = rng.integers(_N_CLASSES, size=_N_POINTS)
        points = places[classes] + rng.standard_normal((_N_POINTS, 2))
        logs.append(Part(points.astype(np.float32), classes))
    return Stream(logs, 0.7, normalized=False)


def history(stream: Stream, order: Sequence[int]) -> MetaPoints:
    """Meet the logs one after the other."""
    params = MetaPointParams(theta=stream.theta, reference="exemplar", min_points=5)
    met = MetaPoints(params, stream.logs[0].points.shape[1], normalized=stream.normalized)
    for log in order:
        stamps_ns = np.arange(_N_POINTS) + log * (_N_POINTS + _PAUSE)
        met.add_data_points(stream.logs[log].points, stamps_ns)
    return met


def v_measure(met: MetaPoints, stream: Stream, preference: str) -> float:
    """Cluster, give each point the cluster of its nearest cluster-point, and score that."""
    labels = met.cluster(AffinityParams(preference=preference)).labels
    references = met.references()[met.is_cluster_point]
    points = np.concatenate([part.points for part in stream.logs])
    nearest = squared_distances(points, references, normalized=stream.normalized).argmin(axis=1)
    classes = np.concatenate([part.classes for part in stream.logs])
    return float(v_measure_score(classes, labels[nearest]))


def compare_streams(make: Callable[[int], Stream], preference: str, seeds: range) -> str:
    """Return a line: V of two orders and of the merged leaves, and mean differences."""
    rows = []
    for seed in seeds:
        stream = make(seed)
        leaves = [history(stream, [log]) for log in range(N_LOGS)]
        three = (
            history(stream, range(N_LOGS)),
            history(stream, OTHER_ORDER),
            merge_meta_points(leaves),
        )
        rows.append([v_measure(one, stream, preference) for one in three])
    first, other, merged = np.array(rows).T
    means = "  ".join(f"{one.mean():7.3f}" for one in (first, other, merged))
    gaps = merged - first
    spread = f"{gaps.mean():+8.3f}  {gaps.min():+.3f} {gaps.max():+.3f}"
    return f"{make.__name__:11} {preference:13} {means}  {spread}  {(other - first).mean():+8.3f}"


def compare_logs(logs: Sequence[Path], folder: Path) -> list[str]:
    """Return lines: AUC of the model of one history and of the merged one, on the same logs."""
    lines = []
    ways = {"history": [], "exemplars": ["--set", "reference=exemplar"], "merged": ["--merge"]}
    for way, words in ways.items():
        _mpap("learn", "--sensor", "scan", *words, "-o", folder / way, *logs)
        for target in TARGETS:
            out = folder / f"{way}-{target[:5]}"
            asked = ("--model", folder / way, "--target", target)
            _mpap("evaluate", *asked, "-o", out, *logs)
            with (out / "evaluate" / "auc.csv").open(encoding="utf-8", newline="") as stream:
                row = next(csv.DictReader(stream))
            scores = f"{float(row['auc']):.4f}  {float(row['auc_per_log']):.4f}"
            lines.append(f"{way:10} {target:8}  {scores}  {row['clusters']:>4} clusters")
    return lines


def _mpap(*words: object) -> None:
    line = [str(MPAP), *map(str, words), "-q"]
    subprocess.run(line, env=environment(), check=True, stdout=subprocess.DEVNULL)


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("logs", nargs="*", type=Path)
    parser.add_argument("--seeds", type=int, nargs=2, default=(100, 112), metavar=("FROM", "TO"))
    words = parser.parse_args()
    print(_COLUMNS)
    for make, preference in (
        (histograms, "median"),
        (histograms, "quantile:0.9"),
        (plane, "median"),
    ):
        print(compare_streams(make, preference, range(*words.seeds)), flush=True)
    if words.logs:
        print("\nmodel      target    AUC     mean per log")
        with tempfile.TemporaryDirectory() as name:
            print("\n".join(compare_logs(words.logs, Path(name))))


if __name__ == "__main__":
    main()
