"""The rows of clusters.csv: what each cluster has seen, and how often it meant a collision."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, TypedDict

from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.clustering.two_scale import TwoScale
from mpap_cli.observations import NS_PER_S, Float64Array, IntArray
from mpap_cli.params import TARGETS, Settings
from mpap_cli.properties.counts import cluster_counts, jeffreys, ratio
from mpap_cli.properties.labels import EARLY
from mpap_cli.properties.visits import Visits
from mpap_cli.systems.columns import Sensor
from mpap_cli.systems.labelling import LogSource
from mpap_cli.systems.model_parts import ModelParts


@dataclass(frozen=True, slots=True)
class ClusterRow:
    """One row of clusters.csv, fields in the order of its columns.

    Where no label is counted the three probabilities are None; only ``p_collision`` of patches
    may then be that of others near them.
    """

    sensor: Sensor
    feature: Annotated[str, "value of a bin of a scan, or the feature of a patch"]
    bins: Annotated[int, "number of bins of a scan, or of patches of an image"]
    profile: Annotated[str, "`robust` or `paper`"]
    cluster: Annotated[int, "number of the cluster"]
    observations: Annotated[int, "scans or patches in it"]
    collisions: Annotated[int, "those labelled as collision, by the target that is learnt"]
    non_collisions: Annotated[int, "those labelled as free"]
    presses: Annotated[int, "presses that these labels come from"]
    visits: Annotated[int, "runs of observations in it, parted by two seconds or more"]
    p_collision: Annotated[
        float | None, "probability of a collision; empty where no label is counted"
    ]
    p_low: Annotated[
        float | None, "lower end of the 95 % interval over visits, with and without a press"
    ]
    p_high: Annotated[float | None, "upper end of it"]
    meta_points: Annotated[int, "meta-points, or exemplars of patches, in it"]
    exemplar_log: Annotated[str, "log of the real observation that stands for it"]
    exemplar_time_s: Annotated[float, "seconds since the first message of that log"]
    exemplar_stamp_ns: Annotated[int, "the same in nanoseconds, as in the log"]
    first_seen_s: Annotated[
        float, "seconds since the first message of the first log that showed it"
    ]
    last_seen_s: Annotated[float, "seconds since the first message of the last log that showed it"]


def pair_of(settings: Settings, target: str) -> int:
    """Return the pair of counts that scores a target (section 4.1).

    Profile ``paper`` knows one pair only; profile ``robust`` scores ``early`` by its own.

    >>> [pair_of(Settings(), target) for target in ("contact", "onset", "early")]
    [1, 1, 2]
    """
    if target == "early" and settings.profile == "robust":
        return EARLY
    return TARGETS.index(settings.properties.learn_target)


def cluster_probabilities(counts: IntArray, profile: str) -> Float64Array:
    """Return the probability of each cluster as the tables show it.

    Parameters
    ----------
    counts : ndarray of shape (k, 2)
        Negatives and positives.
    profile : str
        ``paper``: the share of positives (equation 8); ``robust``: the posterior mean.

    Returns
    -------
    ndarray of shape (k,)
        NaN where nothing is counted.
    """
    if profile == "paper":
        return ratio(counts)
    mean, _, _ = jeffreys(counts[:, 1], counts[:, 0])
    return mean


def make_cluster_rows(parts: ModelParts, visits: Visits) -> list[ClusterRow]:
    """Describe each cluster of a model, given its visits, in the order of the clusters."""
    settings, clustered = parts.settings, parts.clustered
    counts = cluster_counts(parts.meta_points, clustered, pair_of(settings, "contact"))
    shares = cluster_probabilities(counts, settings.profile)
    _, lows, highs = jeffreys(visits.positive, visits.negative)
    return [
        ClusterRow(
            sensor="scan",
            feature=settings.scan.feature,
            bins=settings.scan.bins,
            profile=settings.profile,
            cluster=cluster,
            collisions=int(counts[cluster, 1]),
            non_collisions=int(counts[cluster, 0]),
            presses=int(visits.presses[cluster]),
            visits=int(visits.visits[cluster]),
            p_collision=cell(shares[cluster]),
            p_low=cell(lows[cluster]),
            p_high=cell(highs[cluster]),
            **describe_members(parts.logs, parts.meta_points, members, exemplar),
        )
        for cluster, (members, exemplar) in enumerate(_rows_of_clusters(parts))
    ]


def cell(value: float) -> float | None:
    """Return a figure for a table, None in place of NaN."""
    return None if math.isnan(value) else float(value)


class MemberColumns(TypedDict):
    """Columns that tell of the meta-points or exemplars that a cluster is made of."""

    observations: int
    meta_points: int
    exemplar_log: str
    exemplar_time_s: float
    exemplar_stamp_ns: int
    first_seen_s: float
    last_seen_s: float


def describe_members(
    logs: Sequence[LogSource], points: MetaPoints | TwoScale, members: IntArray, exemplar: int
) -> MemberColumns:
    """Describe one cluster, given the rows of its members and of its exemplar."""
    log = int(points.exemplar_log[exemplar])
    stamp_ns = int(points.exemplar_stamp_ns[exemplar])
    firsts = [_place(logs, log, first) for first in points.first_ns[members].tolist()]
    lasts = [_place(logs, log, last) for last in points.last_ns[members].tolist()]
    return MemberColumns(
        observations=int(points.count[members].sum()),
        meta_points=members.size,
        exemplar_log=logs[log].name,
        exemplar_time_s=(stamp_ns - logs[log].start_ns) / NS_PER_S,
        exemplar_stamp_ns=stamp_ns,
        first_seen_s=min(firsts)[1] / NS_PER_S,
        last_seen_s=max(lasts)[1] / NS_PER_S,
    )


def _rows_of_clusters(parts: ModelParts) -> Iterator[tuple[IntArray, int]]:
    """Yield the meta-points of each cluster and its exemplar, as rows."""
    rows, clustering = parts.meta_points.rows_of(parts.clustered.ids), parts.clustered.clustering
    for cluster, exemplar in enumerate(clustering.exemplars):
        yield rows[clustering.labels == cluster], int(rows[exemplar])


def _place(logs: Sequence[LogSource], otherwise: int, stamp_ns: int) -> tuple[int, int]:
    """Return the first log that holds a stamp, and the nanoseconds since its start."""
    inside = [index for index, log in enumerate(logs) if log.start_ns <= stamp_ns <= log.end_ns]
    index = inside[0] if inside else otherwise
    return index, stamp_ns - logs[index].start_ns
