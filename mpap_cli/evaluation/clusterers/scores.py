"""Clusters against classes: V-measure and its kin (section 5.1.1, Table 2)."""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from mpap_cli.evaluation.clusterers.records import ClusteringResult, LabelledPoints


@dataclass(frozen=True, slots=True, kw_only=True)
class ClusteringRow:
    """One run of one clusterer (a row of cluster.csv).

    Scores are NaN unless the points belong to two classes or more.
    """

    method: Annotated[
        str, "`ap`, `mpap`, `strap`, `k-means`, `mean-shift`, `hdbscan` or `denstream`"
    ]
    variant: Annotated[str, "which form of the method"]
    order_seed: Annotated[
        int | None, "seed of the order of the points; empty where neither order nor seed matters"
    ]
    clusters: Annotated[int, "clusters that were found"]
    points: Annotated[int, "points that were clustered"]
    clustered_points: Annotated[
        int | None, "meta-points that stand for them; empty where nothing is summarized"
    ]
    coverage: Annotated[
        float | None, "share of the points that lie in a cluster; empty where none is left out"
    ]
    v_measure: Annotated[float, "V-measure against the classes, beta 1"]
    homogeneity: Annotated[float, "whether a cluster holds one class only"]
    completeness: Annotated[float, "whether a class lies in one cluster only"]
    ari: Annotated[float, "adjusted Rand index"]
    seconds: Annotated[float, "duration; alone may differ from run to run"]


def score_clustering(
    method: str,
    variant: str,
    order_seed: int | None,
    points: LabelledPoints,
    result: ClusteringResult,
) -> ClusteringRow:
    """Score clusters against the classes of the points.

    Parameters
    ----------
    method, variant : str
        Key of the clusterer.
    order_seed : int or None
        Which order of the points, or seed, this is.
    points : LabelledPoints
        In the order in which they were clustered; those of no class do not count.
    result : ClusteringResult
        Points that a clusterer calls noise count as one more cluster.

    Returns
    -------
    ClusteringRow
        V-measure with beta 1 (Rosenberg and Hirschberg 2007), its two parts, and the
        adjusted Rand index.
    """
    from sklearn.metrics import (  # noqa: PLC0415  # start-up
        adjusted_rand_score,
        homogeneity_completeness_v_measure,
    )

    known = points.classes >= 0
    truth, labels = points.classes[known], result.labels[known]
    homogeneity = completeness = v_measure = ari = math.nan
    if len(np.unique(truth)) > 1:
        homogeneity, completeness, v_measure = homogeneity_completeness_v_measure(truth, labels)
        ari = adjusted_rand_score(truth, labels)
    return ClusteringRow(
        method=method,
        variant=variant,
        order_seed=order_seed,
        clusters=result.clusters,
        points=len(points.classes),
        clustered_points=result.clustered_points,
        coverage=result.coverage,
        v_measure=float(v_measure),
        homogeneity=float(homogeneity),
        completeness=float(completeness),
        ari=float(ari),
        seconds=result.seconds,
    )
