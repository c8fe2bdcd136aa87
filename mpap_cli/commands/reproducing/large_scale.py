"""Whole camera runs clustered by meta-point affinity propagation (section 5.1.2)."""

import time
from dataclasses import dataclass

import numpy as np

from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.clustering.preference import coarse_preference, resolve_preference
from mpap_cli.commands.inputs.progress import no_progress
from mpap_cli.commands.inputs.replaying import follow
from mpap_cli.commands.inputs.sources import Losses, open_sources
from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.camera_logs import (
    INDOOR,
    OUTDOOR,
    Drive,
    Environment,
    draw,
    named_places,
    note_inputs,
    repeats,
)
from mpap_cli.distance import similarities
from mpap_cli.evaluation.clusterers.records import ClustererSettings
from mpap_cli.evaluation.paper_tables import TABLE_3_LARGE
from mpap_cli.features.images.patch_features import PatchEmbedder
from mpap_cli.observations import Float32Array, IntArray
from mpap_cli.params import AffinityParams, Settings

ITEMS = ("table-3",)
META_POINT = ClustererSettings().meta_point
"""The radius fixed for image patches, and the paper's five points."""

_PART = "large-scale data"
_MINUTES = {"Outdoor": 10.0, "Indoor": 15.0}
_HZ = 1.55
_NOTE = (
    f"theta {META_POINT.theta}, {META_POINT.min_points} points; clusters: preference median x "
    "clustered points / 50; duration: of the clustering alone"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """What became of one run: sizes, and CPU seconds with and without reading the images."""

    raw_points: int
    meta_points: int
    cluster_points: int
    coverage: float
    clusters: int
    clusters_by_median: int
    read_s: float
    clustering_s: float


def run(bench: Bench) -> None:
    """Deliver the large-scale lines of table 3.

    Notes
    -----
    Simulated runs are cut to as many patches as the paper's have. What the paper's time
    holds is not said; here it is the clustering, and that of reading, decoding and features
    stands beside it.
    """
    runs = [_summaries(bench, seed) for seed in _seeds(bench)]
    bench.tell("whole runs clustered")
    for place, paper in TABLE_3_LARGE.items():
        found = [one[place] for one in runs if place in one]
        if not found:
            continue
        for quantity, name, printed in (
            ("clusters", "clusters", paper.clusters),
            ("raw points", "raw_points", paper.raw_points),
            ("clustered points", "cluster_points", paper.clustered_points),
            ("meta-points", "meta_points", None),
            ("clusters, plain median", "clusters_by_median", None),
        ):
            ours = [getattr(one, name) for one in found]
            bench.number("table-3", place, quantity, ours, paper=printed, part=_PART, note=_NOTE)
        coverage = [100 * one.coverage for one in found]
        bench.number("table-3", place, "coverage (%)", coverage, part=_PART)
        took = [one.clustering_s for one in found]
        bench.duration("table-3", place, "duration (s)", took, paper=paper.seconds, part=_PART)
        read = [one.read_s for one in found]
        bench.duration("table-3", place, "reading and features (s)", read, part=_PART)
    _compare(bench, runs)


def _seeds(bench: Bench) -> range:
    return repeats(bench)[:1] if named_places(bench) else repeats(bench)


def _environments(bench: Bench, seed: int) -> list[Environment]:
    """Return the runs: all that the user names, or simulated ones."""
    named = named_places(bench)
    note_inputs(bench, named)
    if named:
        return named
    drives = [
        Drive(place=place, world_seed=seed, run=0, minutes=_MINUTES[place.name], hz=_HZ)
        for place in (OUTDOOR, INDOOR)
    ]
    return [Environment(one.place.name, (str(draw(bench, one, one.place.name)),)) for one in drives]


def _summaries(bench: Bench, seed: int) -> dict[str, Summary]:
    """Cluster the runs of one seed."""
    most = {} if named_places(bench) else TABLE_3_LARGE
    found = {}
    for one in _environments(bench, seed):
        limit = most[one.name].raw_points if one.name in most else None
        found[one.name] = _summary(bench, one, limit)
    return found


def _summary(bench: Bench, environment: Environment, limit: int | None) -> Summary:
    """Cluster one run, at most so many of its patches."""
    settings = bench.settings("robust")
    began_s = time.process_time()
    features, stamps_ns = _patches(bench, environment, settings)
    read_s = time.process_time() - began_s
    return summarize(features[:limit], stamps_ns[:limit], read_s)


def _patches(
    bench: Bench, environment: Environment, settings: Settings
) -> tuple[Float32Array, IntArray]:
    """Return the embedded patches (n, d) of a run, image by image, and their stamps (n,)."""
    embedder, losses = PatchEmbedder(settings.image), Losses()
    features: list[Float32Array] = [np.empty((0, embedder.n_dims), np.float32)]
    stamps_ns: list[IntArray] = [np.empty(0, np.int64)]
    for source in open_sources(environment.selection, settings, losses):
        embedder.for_log()
        for _, block in follow(source, 1, no_progress, "read", embedder.transform):
            if block is not None:
                features.append(block.features.reshape(-1, embedder.n_dims))
                stamps_ns.append(np.repeat(block.stamps_ns, embedder.n_patches))
        source.lost_images.update(embedder.skipped)
    bench.left_out(losses.exit_code)
    return np.concatenate(features), np.concatenate(stamps_ns)


def summarize(features: Float32Array, stamps_ns: IntArray, read_s: float = 0.0) -> Summary:
    """Cluster a stream of patches: meta-points, then affinity propagation over the cluster-points.

    Parameters
    ----------
    features : ndarray of shape (n, d)
        Embedded patches, in the order in which they were seen.
    stamps_ns : ndarray of shape (n,)
        Their stamps.
    read_s : float
        CPU seconds that it took to get them.

    Returns
    -------
    Summary
    """
    began_s = time.process_time()
    points = MetaPoints(META_POINT, features.shape[1])
    points.add_data_points(features, stamps_ns)
    members = points.is_cluster_point
    s = similarities(points.exemplars[members], AffinityParams().similarity)
    clustering = affinity_propagation(s, coarse_preference(s), AffinityParams())
    clustering_s = time.process_time() - began_s
    by_median = affinity_propagation(s, resolve_preference(s, "median"), AffinityParams())
    return Summary(
        raw_points=len(features),
        meta_points=points.n_points,
        cluster_points=int(members.sum()),
        coverage=float(points.count[members].sum() / points.count.sum()),
        clusters=len(clustering.exemplars),
        clusters_by_median=len(by_median.exemplars),
        read_s=read_s,
        clustering_s=clustering_s,
    )


def _compare(bench: Bench, runs: list[dict[str, Summary]]) -> None:
    """Say what share of the points is left to cluster."""
    every = [one for found in runs for one in found.values()]
    shares = [100 * one.cluster_points / one.raw_points for one in every]
    by_median = [one.clusters_by_median for one in every]
    ours = [one.clusters for one in every]
    printed = [100 * one.clustered_points / one.raw_points for one in TABLE_3_LARGE.values()]
    bench.finding(
        "table-3",
        f"Of whole camera runs {min(shares):.1f} to {max(shares):.1f} % of the patches are left "
        f"to cluster (paper: {min(printed):.1f} to {max(printed):.1f} %). With the median as "
        f"preference there are {min(by_median)} to {max(by_median)} clusters; they grow with the "
        f"points. With the median times points / 50 there are {min(ours)} to {max(ours)}.",
    )
