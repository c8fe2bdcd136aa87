"""What commands print on stdout, as a table for people or as CSV or JSON for programs."""

import json
import logging
import sys
from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from mpap_cli.cli.info_text import (
    ModelRow,
    TopicRow,
    log_facts,
    log_text,
    model_facts,
    model_rows,
    model_text,
    topic_rows,
)
from mpap_cli.commands.info import Infos, LogInfo, ModelInfo
from mpap_cli.commands.learn import Learnt
from mpap_cli.commands.predict import Predicted
from mpap_cli.commands.progress import Report
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.rows import AucRow
from mpap_cli.outputs import console
from mpap_cli.outputs.evaluate_text import count, evaluate_text
from mpap_cli.outputs.tables import csv_text
from mpap_cli.outputs.text_table import aligned
from mpap_cli.systems.cluster_rows import ClusterRow

if TYPE_CHECKING:
    from mpap_cli.commands.evaluate import Evaluated  # learn has no need of it

SHOWN_CLUSTERS = 8


def progress(title: str, total_s: float | None) -> AbstractContextManager[Report]:
    """Show a bar on stderr, unless told to be quiet."""
    quiet = not logging.getLogger("mpap_cli").isEnabledFor(logging.INFO)
    return console.progress(title, total_s, quiet=quiet)


def print_rows(rows: Sequence[Any], shape: str) -> None:
    """Print one or more rows of one kind."""
    console.print_rows(type(rows[0]), rows, shape, sys.stdout)


def print_learnt(learnt: Learnt, shape: str) -> None:
    """Print what was learnt, the most dangerous clusters first."""
    if shape != "table":
        console.print_rows(ClusterRow, learnt.clusters, shape, sys.stdout)
        return
    presses = "no bumper" if learnt.n_presses is None else count(learnt.n_presses, "press")
    lines = [
        (
            f"{count(learnt.n_scans, 'scan')} of {count(learnt.n_logs, 'log')}, {presses}; "
            f"{count(len(learnt.clusters), 'cluster')} of "
            f"{count(learnt.n_cluster_points, 'cluster-point')} "
            f"({count(learnt.n_meta_points, 'meta-point')}), profile {learnt.profile}"
        )
    ]
    ranked = sorted(learnt.clusters, key=_rank)[:SHOWN_CLUSTERS]
    cells = [
        ("cluster", "p(collision)", "[95 % by visits]", "scans", "presses", "visits", "exemplar")
    ]
    cells += [
        (
            str(row.cluster),
            console.shown(row.p_collision),
            f"[{console.shown(row.p_low)},{console.shown(row.p_high)}]",
            f"{row.observations:,}",
            str(row.presses),
            str(row.visits),
            f"{row.exemplar_log}@{row.exemplar_time_s:.1f}",
        )
        for row in ranked
    ]
    lines += aligned(cells, right={0, 1, 3, 4, 5})
    left = len(learnt.clusters) - len(ranked)
    if left > 0:
        lines.append(f"and {left} more in clusters.csv")
    lines.append(f"results: {learnt.folder}")
    sys.stdout.write("".join(f"{line}\n" for line in lines))


def _rank(row: ClusterRow) -> tuple[float, int]:
    """Sort the most dangerous clusters to the front, those without labels to the end."""
    return (1.0 if row.p_collision is None else -row.p_collision, row.cluster)


def print_evaluated(evaluated: "Evaluated", shape: str) -> None:
    """Print the scores."""
    if shape != "table":
        console.print_rows(AucRow, evaluated.rows, shape, sys.stdout)
        return
    sys.stdout.write(evaluate_text(evaluated.summary))
    sys.stdout.write(f"results: {evaluated.folder}\n")


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedRow:
    """What ``predict --format csv`` prints, and json."""

    logs: int
    scans: int
    predicted: int
    novel: int
    presses_judged: int
    presses_announced: int
    median_lead_s: float | None
    false_alarms_per_min: float | None


def print_predicted(predicted: Predicted, shape: str) -> None:
    """Print how much was predicted."""
    row = PredictedRow(
        logs=predicted.n_logs,
        scans=predicted.n_scans,
        predicted=predicted.n_predicted,
        novel=predicted.n_novel,
        presses_judged=predicted.leads.judged,
        presses_announced=predicted.leads.announced,
        median_lead_s=predicted.leads.median_lead_s,
        false_alarms_per_min=predicted.leads.false_alarms_per_min,
    )
    if shape == "json":
        sys.stdout.write(json.dumps(asdict(row), indent=2) + "\n")
    elif shape == "csv":
        sys.stdout.write(csv_text(PredictedRow, [row]))
    else:
        sys.stdout.write(_predicted_text(predicted))


def _predicted_text(predicted: Predicted) -> str:
    """Lay out what was predicted."""
    lines = [
        (
            f"{count(predicted.n_scans, 'scan')} of {count(predicted.n_logs, 'log')}: "
            f"{predicted.n_predicted:,} with p >= {predicted.threshold:g}, "
            f"{predicted.n_novel:,} unlike anything learnt"
        )
    ]
    leads = predicted.leads
    if leads.judged and leads.median_lead_s is not None:
        lines.append(
            f"{leads.announced} of {count(leads.judged, 'press')} announced, "
            f"median lead {leads.median_lead_s:.1f} s, "
            f"{console.shown(leads.false_alarms_per_min)} false alarms a minute"
        )
    lines.append(f"results: {predicted.folder}")
    return "".join(f"{line}\n" for line in lines)


def print_infos(infos: Infos, shape: str) -> None:
    """Print what logs hold and what models know.

    Raises
    ------
    UsageError
        If both are to stand in one CSV.
    """
    if shape == "table":
        texts = [
            log_text(one) if isinstance(one, LogInfo) else model_text(one) for one in infos.found
        ]
        sys.stdout.write("\n".join(texts))
        return
    facts = [
        log_facts(one) if isinstance(one, LogInfo) else model_facts(one) for one in infos.found
    ]
    if shape == "json":
        sys.stdout.write(json.dumps(facts, indent=2) + "\n")
        return
    topics = [row for one in infos.found if isinstance(one, LogInfo) for row in topic_rows(one)]
    models = [row for one in infos.found if isinstance(one, ModelInfo) for row in model_rows(one)]
    if topics and models:
        msg = "--format csv: logs and models have other columns; ask for one kind, or for json"
        raise UsageError(msg)
    sys.stdout.write(csv_text(ModelRow, models) if models else csv_text(TopicRow, topics))
