"""The rows of clusters.csv for images, and where the patches to show are found."""

from dataclasses import dataclass

import numpy as np

from mpap_cli.observations import IntArray
from mpap_cli.properties.counts import jeffreys
from mpap_cli.properties.visits import Visits
from mpap_cli.systems.appearance_parts import AppearanceParts
from mpap_cli.systems.cluster_rows import ClusterRow, cell, describe_members
from mpap_cli.systems.obstacles import cluster_p_obstacle, coarse_counts

PATCH_FEATURE = "hsv+lbp"
MOST_MEMBERS = 12

PatchPlace = tuple[str, int, int]
"""Base name of a log, stamp of an image in it, number of a patch from the top left."""


@dataclass(frozen=True, slots=True)
class ClusterPictures:
    """What a picture of one coarse cluster shows, and where its patches are found.

    ``p_obstacle`` is None where nothing is labelled; ``members`` are other exemplars of the
    cluster, those that stand for most patches first.
    """

    cluster: int
    p_obstacle: float | None
    observations: int
    presses: int
    exemplar: PatchPlace
    members: tuple[PatchPlace, ...]


def make_patch_rows(parts: AppearanceParts, visits: Visits) -> list[ClusterRow]:
    """Describe each coarse cluster of a model, given its visits, in the order of the clusters.

    ``meta_points`` counts its exemplars, ``observations`` the patches that they stand for;
    patches that are still outliers are in no cluster. ``p_collision`` agrees with what is
    said of patches: :func:`~mpap_cli.systems.obstacles.cluster_p_obstacle`.
    """
    counts = coarse_counts(parts.two_scale, parts.coarse)
    shares = cluster_p_obstacle(parts.two_scale, parts.coarse, parts.settings)
    _, lows, highs = jeffreys(visits.positive, visits.negative)
    rows, columns = parts.settings.image.rows_columns()
    return [
        ClusterRow(
            sensor="image",
            feature=PATCH_FEATURE,
            bins=rows * columns,
            profile=parts.settings.profile,
            cluster=cluster,
            collisions=int(counts[cluster, 1]),
            non_collisions=int(counts[cluster, 0]),
            presses=int(visits.presses[cluster]),
            visits=int(visits.visits[cluster]),
            p_collision=cell(shares[cluster]),
            p_low=cell(lows[cluster]),
            p_high=cell(highs[cluster]),
            **describe_members(parts.logs, parts.two_scale, _members(parts, cluster), exemplar),
        )
        for cluster, exemplar in enumerate(parts.coarse.clustering.exemplars.tolist())
    ]


def find_pictures(parts: AppearanceParts, rows: list[ClusterRow]) -> list[ClusterPictures]:
    """Return where the exemplar and up to 12 members of each coarse cluster are found."""
    places = _places(parts)
    count = parts.two_scale.count
    pictures = []
    for row in rows:
        exemplar = int(parts.coarse.clustering.exemplars[row.cluster])
        members = _members(parts, row.cluster)
        others = members[members != exemplar]
        heaviest = others[np.argsort(-count[others], kind="stable")][:MOST_MEMBERS]
        pictures.append(
            ClusterPictures(
                cluster=row.cluster,
                p_obstacle=row.p_collision,
                observations=row.observations,
                presses=row.presses,
                exemplar=places[exemplar],
                members=tuple(places[member] for member in heaviest),
            )
        )
    return pictures


def _members(parts: AppearanceParts, cluster: int) -> IntArray:
    """Return the long-term exemplars of one coarse cluster, as rows."""
    return np.flatnonzero(parts.coarse.clustering.labels == cluster)


def _places(parts: AppearanceParts) -> list[PatchPlace]:
    """Return where each long-term exemplar was seen."""
    exemplars = parts.two_scale
    columns = (exemplars.exemplar_log, exemplars.exemplar_stamp_ns, exemplars.exemplar_patch)
    return [
        (parts.logs[log].name, stamp_ns, patch)
        for log, stamp_ns, patch in zip(*(column.tolist() for column in columns), strict=True)
    ]
