"""What ``mpap cluster`` prints: one line a method beside the paper's number, and findings."""

import math
import sys

from mpap_cli.commands.cluster import Clustered
from mpap_cli.evaluation.clusterers.scores import ClusteringRow
from mpap_cli.evaluation.clusterers.summary import MethodSummary, findings, summarize
from mpap_cli.outputs import console
from mpap_cli.outputs.text_table import aligned, count, printable

_HEAD = (
    "method",
    "variant",
    "V-measure",
    "paper's Table 2",
    "homogeneity",
    "completeness",
    "ARI",
    "clusters",
    "clustered points",
    "coverage",
    "CPU s",
)


def print_clustered(found: Clustered, shape: str) -> None:
    """Print the means as a table, or every run as CSV or JSON."""
    if shape == "table":
        sys.stdout.write(clustered_text(found))
    else:
        console.print_rows(ClusteringRow, found.rows, shape, sys.stdout)


def clustered_text(found: Clustered) -> str:
    """Lay out the means over the orders, and say what stands out."""
    summaries = summarize(found.rows)
    n_points, n_classes = count(found.n_points, "patch"), count(found.n_classes, "class")
    names = ", ".join(found.class_names)
    lines = [f"{n_points} of {n_classes}: {names}"]
    lines += aligned([_HEAD, *(_cells(one) for one in summaries)], right=set(range(2, len(_HEAD))))
    orders = count(found.orders, "order")
    lines.append(
        f"V-measure: mean and standard deviation over {orders} of the patches (seeds of k-means); "
        "the paper clustered other patches."
    )
    if any(one.method == "hdbscan" for one in summaries):
        lines.append("hdbscan's noise counts as one cluster; (nearest) gives it to the nearest.")
    lines += findings(summaries, found.n_classes)
    lines.append(f"results: {printable(str(found.folder))}")
    return "".join(f"{line}\n" for line in lines)


def _cells(one: MethodSummary) -> tuple[str, ...]:
    """Return one line of the table."""
    spread = f" +-{one.spread:.2f}" if one.runs > 1 and not math.isnan(one.spread) else ""
    return (
        one.method,
        one.variant,
        _share(one.v_measure) + spread.replace("0.", ".", 1),
        _share(one.paper),
        _share(one.homogeneity),
        _share(one.completeness),
        _share(one.ari),
        f"{one.clusters:.1f}",
        "-" if one.clustered_points is None else f"{one.clustered_points:,.0f}",
        _share(one.coverage),
        f"{one.seconds:.3f}",
    )


def _share(value: float | None) -> str:
    """Return a number from 0 to 1 in two digits, - where there is none."""
    return "-" if value is None or math.isnan(value) else f"{value:.2f}"
