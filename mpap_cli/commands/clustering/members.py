"""What the clusters of labelled patches look like: exemplars and members (Fig. 15)."""

from dataclasses import dataclass

import numpy as np

from mpap_cli.commands.inputs.labelled_patches import LabelledPatches
from mpap_cli.evaluation.clusterers.records import ClusteringResult
from mpap_cli.observations import IntArray
from mpap_cli.outputs.patch_pictures import PatchCluster

_MOST_MEMBERS = 12


@dataclass(frozen=True, slots=True, eq=False)
class Ran:
    """One run: the order (n,) of the points, and the clusters of the points in that order."""

    order: IntArray
    result: ClusteringResult


def member_pictures(patches: LabelledPatches, ran: Ran) -> list[PatchCluster]:
    """Return the clusters of a run with pictures.

    Parameters
    ----------
    patches : LabelledPatches
        In their own order.
    ran : Ran
        A run whose clusters have exemplars.

    Returns
    -------
    list of PatchCluster
        The largest first; each with its exemplar and up to 12 members, the nearest to the
        exemplar first, the farthest last, the others evenly between them.
    """
    labels = ran.result.labels
    exemplars = np.zeros(0, np.int64) if ran.result.exemplars is None else ran.result.exemplars
    sizes = np.bincount(labels[labels >= 0], minlength=len(exemplars))
    by_size = np.argsort(-sizes, kind="stable")
    exemplar_rows = ran.order[exemplars[by_size]].tolist()
    groups = [ran.order[labels == number] for number in by_size]
    members = [
        _near_and_far(patches, group, exemplar)
        for group, exemplar in zip(groups, exemplar_rows, strict=True)
    ]
    seen = patches.draw(row for rows in (exemplar_rows, *members) for row in rows)
    return [
        PatchCluster(
            cluster=number,
            p_obstacle=None,
            observations=len(groups[number]),
            presses=None,
            exemplar=seen.get(exemplar),
            members=tuple(seen[row] for row in members[number] if row in seen),
            note=_main_class(patches, groups[number]),
        )
        for number, exemplar in enumerate(exemplar_rows)
    ]


def _near_and_far(patches: LabelledPatches, group: IntArray, exemplar: int) -> list[int]:
    """Return rows of members, from the nearest to the exemplar to the farthest."""
    rest = group[group != exemplar]
    features = patches.points.features
    steps = np.square(features[rest] - features[exemplar]).sum(axis=1)
    by_distance = rest[np.lexsort((rest, steps))]
    at = np.linspace(0, len(rest) - 1, min(_MOST_MEMBERS, len(rest)))
    return [int(by_distance[round(place)]) for place in at]


def _main_class(patches: LabelledPatches, rows: IntArray) -> str:
    """Return the class that most patches are of, and how many of them."""
    if not rows.size:
        return "no patch"
    counts = np.bincount(patches.points.classes[rows])
    share = 100 * counts.max() / rows.size
    return f"{share:.0f} % {patches.class_names[int(counts.argmax())]}"
