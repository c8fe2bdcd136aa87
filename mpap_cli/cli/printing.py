"""What commands print on stdout, as a table for people or as CSV or JSON for programs."""

import json
import sys
from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from mpap_cli.cli.info_text import TopicRow, log_facts, log_text, topic_rows
from mpap_cli.cli.model_text import ModelRow, model_facts, model_rows, model_text
from mpap_cli.cli.talk import is_quiet
from mpap_cli.commands.info import Infos, LogInfo, ModelInfo
from mpap_cli.commands.inputs.progress import Report
from mpap_cli.errors import UsageError
from mpap_cli.outputs import console
from mpap_cli.outputs.tables import csv_text
from mpap_cli.outputs.text_table import printable

if TYPE_CHECKING:  # each command imports what it prints, and not the others
    from mpap_cli.commands.compare import Compared
    from mpap_cli.commands.evaluate import Evaluated
    from mpap_cli.commands.extract import Extracted
    from mpap_cli.commands.learning.summary import Learnt
    from mpap_cli.commands.novelty import Novelty
    from mpap_cli.commands.predict import Predicted
    from mpap_cli.commands.reproduce import Reproduced
    from mpap_cli.commands.similar import Similar


def progress(title: str, total_s: float | None) -> AbstractContextManager[Report]:
    """Show a bar on stderr, unless told to be quiet."""
    return console.progress(title, total_s, quiet=is_quiet())


def print_rows(rows: Sequence[Any], shape: str) -> None:
    """Print one or more rows of one kind."""
    console.print_rows(type(rows[0]), rows, shape, sys.stdout)


def print_learnt(learnt: "Learnt", shape: str) -> None:
    """Print what was learnt."""
    from mpap_cli.cli.learnt_text import learnt_text
    from mpap_cli.systems.cluster_rows import ClusterRow

    if shape == "table":
        sys.stdout.write(learnt_text(learnt))
    else:
        console.print_rows(ClusterRow, learnt.clusters, shape, sys.stdout)


def print_evaluated(evaluated: "Evaluated", shape: str) -> None:
    """Print the scores."""
    from mpap_cli.evaluation.rows import AucRow
    from mpap_cli.outputs.evaluate_text import evaluate_text

    if shape != "table":
        console.print_rows(AucRow, evaluated.rows, shape, sys.stdout)
        return
    sys.stdout.write(evaluate_text(evaluated.summary))
    sys.stdout.write(f"results: {printable(str(evaluated.folder))}\n")


def print_predicted(predicted: "Predicted", shape: str) -> None:
    """Print how much was predicted."""
    from mpap_cli.cli.predicted_text import PredictedRow, predicted_row, predicted_text

    row = predicted_row(predicted)
    if shape == "json":
        sys.stdout.write(json.dumps(asdict(row), indent=2) + "\n")
    elif shape == "csv":
        sys.stdout.write(csv_text(PredictedRow, [row]))
    else:
        sys.stdout.write(predicted_text(predicted))


def print_novelty(found: "Novelty", shape: str) -> None:
    """Print the windows, and what was new where a log begins."""
    from mpap_cli.cli.novelty_text import novelty_text
    from mpap_cli.evaluation.novelty import NoveltyRow

    if shape != "table":
        console.print_rows(NoveltyRow, found.rows, shape, sys.stdout)
        return
    sys.stdout.write(novelty_text(found))


def print_extracted(found: "Extracted", shape: str) -> None:
    """Print what was cut."""
    from mpap_cli.cli.extracted_text import extracted_text
    from mpap_cli.commands.extracting.cutting import SegmentRow

    if shape == "table":
        sys.stdout.write(extracted_text(found))
    else:
        console.print_rows(SegmentRow, found.rows, shape, sys.stdout)


def print_compared(found: "Compared", shape: str) -> None:
    """Print how much of each log the others do not explain."""
    from mpap_cli.cli.compared_text import compared_text
    from mpap_cli.evaluation.comparing import CompareRow

    if shape == "table":
        sys.stdout.write(compared_text(found))
    else:
        console.print_rows(CompareRow, found.rows, shape, sys.stdout)


def print_similar(found: "Similar", shape: str) -> None:
    """Print the moments that are most similar."""
    from mpap_cli.cli.similar_text import similar_text
    from mpap_cli.evaluation.remembering import SimilarRow

    if shape == "table":
        sys.stdout.write(similar_text(found))
    else:
        console.print_rows(SimilarRow, found.rows, shape, sys.stdout)


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
    from mpap_cli.evaluation.reproduced import ReproducedRow
    from mpap_cli.outputs.reproduced_text import reproduced_text

    if shape != "table":
        console.print_rows(ReproducedRow, found.rows, shape, sys.stdout)
        return
    sys.stdout.write(reproduced_text(found.rows, found.findings))
    sys.stdout.write(f"results: {printable(str(found.folder))}\n")
