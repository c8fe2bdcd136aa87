"""What commands print on stdout, as a table for people or as CSV or JSON for programs."""

import json
import logging
import sys
from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from mpap_cli.cli.info_text import TopicRow, log_facts, log_text, topic_rows
from mpap_cli.cli.learnt_text import learnt_text
from mpap_cli.cli.model_text import ModelRow, model_facts, model_rows, model_text
from mpap_cli.cli.novelty_text import novelty_text
from mpap_cli.cli.predicted_text import PredictedRow, predicted_row, predicted_text
from mpap_cli.commands.info import Infos, LogInfo, ModelInfo
from mpap_cli.commands.inputs.progress import Report
from mpap_cli.commands.learn import Learnt
from mpap_cli.commands.novelty import Novelty
from mpap_cli.commands.predict import Predicted
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.novelty import NoveltyRow
from mpap_cli.evaluation.reproduced import ReproducedRow
from mpap_cli.evaluation.rows import AucRow
from mpap_cli.outputs import console
from mpap_cli.outputs.evaluate_text import evaluate_text
from mpap_cli.outputs.reproduced_text import reproduced_text
from mpap_cli.outputs.tables import csv_text
from mpap_cli.outputs.text_table import printable
from mpap_cli.systems.cluster_rows import ClusterRow

if TYPE_CHECKING:
    from mpap_cli.commands.evaluate import Evaluated  # learn has no need of it
    from mpap_cli.commands.reproduce import Reproduced


def progress(title: str, total_s: float | None) -> AbstractContextManager[Report]:
    """Show a bar on stderr, unless told to be quiet."""
    quiet = not logging.getLogger("mpap_cli").isEnabledFor(logging.INFO)
    return console.progress(title, total_s, quiet=quiet)


def print_rows(rows: Sequence[Any], shape: str) -> None:
    """Print one or more rows of one kind."""
    console.print_rows(type(rows[0]), rows, shape, sys.stdout)


def print_learnt(learnt: Learnt, shape: str) -> None:
    """Print what was learnt."""
    if shape == "table":
        sys.stdout.write(learnt_text(learnt))
    else:
        console.print_rows(ClusterRow, learnt.clusters, shape, sys.stdout)


def print_evaluated(evaluated: "Evaluated", shape: str) -> None:
    """Print the scores."""
    if shape != "table":
        console.print_rows(AucRow, evaluated.rows, shape, sys.stdout)
        return
    sys.stdout.write(evaluate_text(evaluated.summary))
    sys.stdout.write(f"results: {printable(str(evaluated.folder))}\n")


def print_predicted(predicted: Predicted, shape: str) -> None:
    """Print how much was predicted."""
    row = predicted_row(predicted)
    if shape == "json":
        sys.stdout.write(json.dumps(asdict(row), indent=2) + "\n")
    elif shape == "csv":
        sys.stdout.write(csv_text(PredictedRow, [row]))
    else:
        sys.stdout.write(predicted_text(predicted))


def print_novelty(found: Novelty, shape: str) -> None:
    """Print the windows, and what was new where a log begins."""
    if shape != "table":
        console.print_rows(NoveltyRow, found.rows, shape, sys.stdout)
        return
    sys.stdout.write(novelty_text(found))


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


def print_reproduced(found: "Reproduced", shape: str) -> None:
    """Print the tables with the paper's numbers beside ours, and what was found."""
    if shape != "table":
        console.print_rows(ReproducedRow, found.rows, shape, sys.stdout)
        return
    sys.stdout.write(reproduced_text(found.rows, found.findings))
    sys.stdout.write(f"results: {printable(str(found.folder))}\n")
