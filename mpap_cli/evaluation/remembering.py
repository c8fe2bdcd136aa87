"""Which remembered moments look most like another one."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from mpap_cli.observations import NS_PER_S, Float32Array
from mpap_cli.systems.columns import Cluster, LogName, StampNs, TimeS


class Moment(NamedTuple):
    """Where an observation was made: log, its start, the stamp; cluster -1: in none."""

    log: str
    start_ns: int
    stamp_ns: int
    cluster: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SimilarRow:
    """One remembered moment, the nearest first (a row of similar.csv)."""

    log: LogName
    time_s: TimeS
    stamp_ns: StampNs
    cluster: Cluster
    distance: Annotated[float, "Euclidean distance between the embedded observations"]


def nearest_moments(
    moments: Sequence[Moment],
    known: Float32Array,
    seen: Moment,
    features: Float32Array,
    count: int,
    apart_s: float,
) -> list[SimilarRow]:
    """Rank remembered moments by their distance to one that is seen.

    Parameters
    ----------
    moments : sequence of Moment
        The m moments that are remembered.
    known : ndarray of shape (m, d)
        Their embedded observations.
    seen : Moment
        The one asked for; of its log nothing later or less than ``apart_s`` before it counts.
    features : ndarray of shape (n, d)
        What is seen there: one scan, or the patches of an image, of which the nearest counts.
    count : int
        Most moments returned.
    apart_s : float
        Of moments of one log nearer together than this only the most similar one counts.

    Returns
    -------
    list of SimilarRow
        Distances are Euclidean, between embedded observations.
    """
    if not moments:
        return []
    gaps = known[None, :, :].astype(np.float64) - features[:, None, :]
    distances = np.sqrt((gaps**2).sum(axis=2)).min(axis=0)
    found: list[SimilarRow] = []
    kept: list[Moment] = []
    apart_ns = round(apart_s * NS_PER_S)
    for place in np.argsort(distances, kind="stable").tolist():
        one = moments[place]
        is_same_log = (one.log, one.start_ns) == (seen.log, seen.start_ns)
        if is_same_log and one.stamp_ns > seen.stamp_ns - apart_ns:
            continue
        if any(
            one.log == other.log and abs(one.stamp_ns - other.stamp_ns) < apart_ns for other in kept
        ):
            continue
        kept.append(one)
        found.append(
            SimilarRow(
                log=one.log,
                time_s=(one.stamp_ns - one.start_ns) / NS_PER_S,
                stamp_ns=one.stamp_ns,
                cluster=one.cluster if one.cluster >= 0 else None,
                distance=float(distances[place]),
            )
        )
        if len(found) == count:
            break
    return found
