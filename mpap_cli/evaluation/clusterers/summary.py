"""Many runs of many clusterers in few words: means, spreads, and what stands out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from mpap_cli.evaluation.clusterers.scores import ClusteringRow
from mpap_cli.evaluation.paper_tables import TABLE_2

PAPER: Mapping[tuple[str, str], float] = MappingProxyType(
    {
        ("ap", "default"): TABLE_2["Affinity propagation"],
        ("mpap", "default"): TABLE_2["Meta-point affinity propagation"],
        ("strap", "fine"): TABLE_2["STRAP"],
        ("k-means", "raw"): TABLE_2["k-means"],
        ("mean-shift", "default"): TABLE_2["Mean shift"],
    }
)
"""V-measure of the paper (Table 2), on other patches, beside the variant nearest to it."""

FEW_CLUSTER_POINTS = 20
LEVEL = 0.005
_KNOWS_CLASSES = "k-means"


@dataclass(frozen=True, slots=True, kw_only=True)
class MethodSummary:
    """All runs of one method and variant: means, and the spread of the V-measure.

    ``paper`` is the V-measure in the paper's Table 2, None where it has none.
    """

    method: str
    variant: str
    runs: int
    v_measure: float
    spread: float
    homogeneity: float
    completeness: float
    ari: float
    clusters: float
    clustered_points: float | None
    coverage: float | None
    seconds: float
    paper: float | None

    @property
    def name(self) -> str:
        """Method, and variant unless it is the default."""
        return self.method if self.variant == "default" else f"{self.method} ({self.variant})"


def summarize(rows: Sequence[ClusteringRow]) -> list[MethodSummary]:
    """Return one summary a method and variant, in the order of the rows.

    The spread is the standard deviation over the runs, 0 of a single one.
    """
    groups: dict[tuple[str, str], list[ClusteringRow]] = {}
    for row in rows:
        groups.setdefault((row.method, row.variant), []).append(row)
    return [_summary(key, group) for key, group in groups.items()]


def _summary(key: tuple[str, str], rows: Sequence[ClusteringRow]) -> MethodSummary:
    """Return the summary of some runs of one method and variant."""

    def mean(name: str) -> float:
        return float(np.mean([getattr(row, name) for row in rows]))

    summarized = rows[0].clustered_points is not None
    covered = rows[0].coverage is not None
    return MethodSummary(
        method=key[0],
        variant=key[1],
        runs=len(rows),
        v_measure=mean("v_measure"),
        spread=float(np.std([row.v_measure for row in rows])),
        homogeneity=mean("homogeneity"),
        completeness=mean("completeness"),
        ari=mean("ari"),
        clusters=mean("clusters"),
        clustered_points=mean("clustered_points") if summarized else None,
        coverage=mean("coverage") if covered else None,
        seconds=mean("seconds"),
        paper=PAPER.get(key),
    )


def findings(summaries: Sequence[MethodSummary], n_classes: int) -> list[str]:
    """Say in words what stands out, about MPAP before all.

    Parameters
    ----------
    summaries : sequence of MethodSummary
        From :func:`summarize`.
    n_classes : int
        Classes of the points.

    Returns
    -------
    list of str
        Sentences; they claim a difference only where it is larger than the spread of MPAP
        over the orders and than 0.005.
    """
    known = {(one.method, one.variant): one for one in summaries}
    mpap = known.get(("mpap", "default"))
    if mpap is None:
        return []
    said = _coverage_words(mpap)
    if n_classes < 2:  # noqa: PLR2004
        return ["one class: V-measure and its kin mean nothing and are left empty.", *said]
    automatic = [one for one in summaries if one.method == "ap"]
    if automatic:
        best = max(automatic, key=lambda one: one.v_measure)
        words = _against(mpap, best)
        said.append(
            f"mpap is {words} affinity propagation over all points with the better of its "
            f"automatic preferences ({best.variant}, {best.v_measure:.2f}), and takes "
            f"{mpap.seconds:.3f} s where that takes {best.seconds:.3f} s."
        )
    said += _given_classes(mpap, summaries, n_classes)
    others = [
        one
        for one in summaries
        if one.method not in {"mpap", "ap", _KNOWS_CLASSES} and _is_above(one, mpap)
    ]
    if others:
        named = ", ".join(f"{one.name} {one.v_measure:.2f}" for one in others)
        said.append(f"without being told the number of classes, too, and above mpap: {named}.")
    return said


def _given_classes(
    mpap: MethodSummary, summaries: Sequence[MethodSummary], n_classes: int
) -> list[str]:
    """Compare with k-means, which is told how many classes there are."""
    told = [one for one in summaries if one.method == _KNOWS_CLASSES]
    words = [f"{one.variant} histograms {one.v_measure:.2f}" for one in told]
    beaten = [one.variant for one in told if _is_above(one, mpap)]
    if not told:
        return []
    on = f"on {' and '.join(beaten)} histograms it beats mpap"
    verdict = on if beaten else "neither beats mpap by more than the order of the patches does"
    return [f"k-means is told that there are {n_classes} classes: {', '.join(words)}; {verdict}."]


def _coverage_words(mpap: MethodSummary) -> list[str]:
    """Say so where meta-points do not stand for the points."""
    n_cluster_points, coverage = mpap.clustered_points or 0.0, mpap.coverage or 0.0
    words = ""
    if n_cluster_points < FEW_CLUSTER_POINTS:
        words = (
            f"cluster-points of mpap: {n_cluster_points:.0f}, too few to tell classes apart; "
            "give more patches, or try another theta or fewer min-points."
        )
    elif coverage < 1 / 2:
        words = (
            f"cluster-points cover {100 * coverage:.0f} % of the points, the rest is noise to "
            "mpap; a larger theta covers more."
        )
    return [words] if words else []


def _is_above(one: MethodSummary, mpap: MethodSummary) -> bool:
    """Tell whether a method scores higher than MPAP by more than chance of the order."""
    return one.v_measure - mpap.v_measure > max(LEVEL, mpap.spread)


def _against(mpap: MethodSummary, other: MethodSummary) -> str:
    """Compare the V-measure of MPAP with another in words."""
    difference = mpap.v_measure - other.v_measure
    if abs(difference) <= max(LEVEL, mpap.spread):
        return "level with"
    return f"{abs(difference):.2f} {'above' if difference > 0 else 'below'}"
