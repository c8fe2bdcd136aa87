"""Labelled image patches under every clusterer (section 5.1.1): tables 2 and 3, figure 7."""

from collections import defaultdict
from collections.abc import Mapping, Sequence

from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.texture_sets import TextureSet, draw_classes, texture_sets
from mpap_cli.evaluation.clusterers.methods import CLUSTERERS, is_there, warm_up
from mpap_cli.evaluation.clusterers.records import PATCH_SETTINGS
from mpap_cli.evaluation.clusterers.scores import ClusteringRow, score_clustering
from mpap_cli.evaluation.paper_tables import TABLE_2, TABLE_3_OUTDOOR
from mpap_cli.evaluation.reproduced import spread

METHOD_WORDS: dict[tuple[str, str], str] = {
    ("ap", "default"): "Affinity propagation",
    ("mpap", "default"): "Meta-point affinity propagation",
    ("strap", "default"): "STRAP",
    ("k-means", "raw"): "k-means",
    ("mean-shift", "default"): "Mean shift",
}
"""The methods of table 2; k-means and mean shift are given what the paper seems to give them."""

_TABLE_3 = {"AP": ("ap", "default"), "MPAP": ("mpap", "default")}
_PART = "image patches"
_NOTE = (
    "k-means is told the number of classes, the others find theirs. Variants other than default "
    "as in `mpap cluster`: preference at the median similarity, theta 0.13, exemplars before the "
    "coarse level (fine), plain or square-root histograms, noise put into the nearest cluster."
)
Rows = Mapping[tuple[str, str], Sequence[ClusteringRow]]


def run(bench: Bench) -> None:
    """Deliver table 2, the image patches of table 3, and figure 7."""
    clusters = bench.wants("table-2", "table-3")
    sets = texture_sets(bench, None if clusters else 1)
    if clusters:
        rows = _cluster_all(bench, sets)
        _write_table_2(bench, rows)
        _write_table_3(bench, rows)
        _compare(bench, rows)
    if bench.wants("figure-7"):
        draw_classes(bench, sets[0])


def _cluster_all(bench: Bench, sets: Sequence[TextureSet]) -> Rows:
    """Run every clusterer on every set, its points in an order of their own."""
    warm_up()
    rows: dict[tuple[str, str], list[ClusteringRow]] = defaultdict(list)
    for one in sets:
        points = one.shuffled()
        for method, clusterer in CLUSTERERS.items():
            if one.n > (clusterer.most_points or one.n) or not is_there(clusterer):
                continue
            result = clusterer.run(points, PATCH_SETTINGS, one.seed)
            rows[method].append(score_clustering(*method, one.seed, points, result))
        bench.tell(f"set {one.seed} clustered by {len(rows)} methods")
    return rows


def _write_table_2(bench: Bench, rows: Rows) -> None:
    """Write the scores, the methods of the paper first."""
    order = [*METHOD_WORDS, *(method for method in rows if method not in METHOD_WORDS)]
    for method in [method for method in order if method in rows]:
        words = METHOD_WORDS.get(method, f"{method[0]}, {method[1]}")
        found = rows[method]
        for quantity, values in (
            ("V-measure", [one.v_measure for one in found]),
            ("homogeneity", [one.homogeneity for one in found]),
            ("completeness", [one.completeness for one in found]),
            ("ARI", [one.ari for one in found]),
            ("clusters", [one.clusters for one in found]),
            ("coverage", [one.coverage for one in found]),
        ):
            paper = TABLE_2.get(words) if quantity == "V-measure" else None
            bench.number("table-2", words, quantity, values, paper=paper, note=_NOTE)
        seconds = [one.seconds for one in found]
        bench.duration("table-2", words, "duration (s)", seconds, note=_NOTE)


def _write_table_3(bench: Bench, rows: Rows) -> None:
    """Write the lines of the outdoor patches."""
    for line, method in _TABLE_3.items():
        paper, found = TABLE_3_OUTDOOR[line], rows.get(method, ())
        if not found:
            continue
        points = [one.points for one in found]
        left = [one.clustered_points or one.points for one in found]
        for quantity, values, printed in (
            ("clusters", [one.clusters for one in found], paper.clusters),
            ("raw points", points, paper.raw_points),
            ("clustered points", left, paper.clustered_points),
        ):
            bench.number("table-3", line, quantity, values, paper=printed, part=_PART)
        seconds = [one.seconds for one in found]
        bench.duration("table-3", line, "duration (s)", seconds, paper=paper.seconds, part=_PART)


def _compare(bench: Bench, rows: Rows) -> None:
    """Hold what the text says of table 2 against this run."""
    v = {method: spread([one.v_measure for one in found]).mean for method, found in rows.items()}
    mpap, ap, strap = (v.get((name, "default")) for name in ("mpap", "ap", "strap"))
    if mpap is None or ap is None or strap is None:
        return
    bench.finding(
        "table-2",
        '"Affinity propagation and meta-point affinity propagation perform at a similar level": '
        f"here {ap:.2f} and {mpap:.2f}. STRAP, worse than both in the paper, reaches {strap:.2f}.",
    )
    raw, root = (v.get(("k-means", variant)) for variant in ("raw", "square-root"))
    if raw is not None and root is not None:
        beaten = "more" if root > mpap else "not more"
        bench.finding(
            "table-2",
            f"k-means, which is told the number of classes, reaches {raw:.2f} on plain histograms "
            f"and {root:.2f} on their square roots: {beaten} than meta-points, which find it.",
        )
    took = {method: sum(one.seconds for one in found) for method, found in rows.items()}
    faster = took["ap", "default"] / took["mpap", "default"]
    printed = TABLE_3_OUTDOOR["AP"].seconds / TABLE_3_OUTDOOR["MPAP"].seconds
    bench.finding(
        "table-3",
        f"On image patches meta-points are {faster:.0f} times as fast as affinity propagation on "
        f"all of them (paper: {printed:.1f} times).",
    )
