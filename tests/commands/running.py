"""The command line run in this process, and its results read back."""

import csv
import hashlib
import io
import json
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from mpap_cli.cli.main import main

FIXTURES = Path(__file__).parents[2] / "fixtures"
BAG, MCAP = FIXTURES / "indoor-a.bag", FIXTURES / "indoor-a2.mcap"

COUNTS = ("observations", "collisions", "non_collisions", "meta_points", "exemplar_stamp_ns")
PAPER = ("--feature", "global-diff", "--bins", "6")

CLUSTER_COLUMNS = (
    "sensor feature bins profile cluster observations collisions non_collisions presses visits "
    "p_collision p_low p_high meta_points exemplar_log exemplar_time_s exemplar_stamp_ns "
    "first_seen_s last_seen_s"
)
COLUMNS = {
    "clusters.csv": CLUSTER_COLUMNS,
    "auc.csv": "method feature bins profile readout target protocol truth auc auc_low auc_high "
    "auc_per_log folds_scored auc_in_sample average_precision brier brier_skill ece positives "
    "negatives presses logs clusters meta_points auc_per_log_low auc_per_log_high visible_presses "
    "auc_visible auc_visible_low auc_visible_high auc_visible_per_log auc_visible_per_log_low "
    "auc_visible_per_log_high calibration_slope calibration_intercept",
    "differences.csv": "method feature bins profile against against_feature against_bins "
    "against_profile target protocol truth scored logs diff_per_log diff_per_log_low "
    "diff_per_log_high diff diff_low diff_high",
    "operating.csv": "method feature bins profile target protocol threshold presses announced "
    "recall median_lead_s visible_presses visible_announced visible_recall "
    "visible_median_lead_s false_alarms_per_min alarm_share",
    "roc.csv": "method feature bins profile target protocol threshold fpr tpr",
    "timeline.csv": "log log_index time_s stamp_ns cluster p_cluster p_collision predicted truth "
    "distance novel alarm",
    "presses.csv": "log log_index start_s end_s predicted lead_s visible alarm_lead_s",
}
EVALUATE_FILES = {
    *COLUMNS,
    "auc.tex",
    *(f"{plot}.{form}" for plot in ("roc", "timeline", "calibration") for form in ("png", "svg")),
    "settings.json",
}
LEARN_FILES = {
    "clusters.csv",
    "model.npz",
    "recording.npz",
    "exemplars.npz",
    "exemplars.png",
    "settings.json",
}


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a command ended."""

    code: int
    out: str
    err: str


def mpap(*words: object) -> Outcome:
    """Run ``mpap`` with words; whatever is no way to end for a command is raised."""
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err), pytest.raises(SystemExit) as left:
        main([str(word) for word in words])
    return Outcome(int(left.value.code or 0), out.getvalue(), err.getvalue())


def done(*words: object) -> Outcome:
    """Run ``mpap`` with words; it must end well."""
    outcome = mpap(*words)
    assert outcome.code == 0, outcome.err
    return outcome


def rows_of(path: Path) -> list[dict[str, str]]:
    """Read a table."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def counts_of(folder: Path, *more: str) -> list[dict[str, str]]:
    """Return the columns of clusters.csv that are counted scan by scan, and some more."""
    rows = rows_of(folder / "learn" / "clusters.csv")
    return [{name: row[name] for name in (*COUNTS, *more)} for row in rows]


def evaluated(out: Path, name: str) -> list[dict[str, str]]:
    """Read a table of the evaluation."""
    return rows_of(out / "evaluate" / f"{name}.csv")


def header_of(path: Path) -> str:
    """Return the columns of a table, parted by blanks."""
    with path.open(encoding="utf-8", newline="") as file:
        return " ".join(next(csv.reader(file)))


def record_of(folder: Path) -> dict[str, Any]:
    """Read settings.json."""
    record: dict[str, Any] = json.loads((folder / "settings.json").read_text(encoding="utf-8"))
    return record


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def bytes_of(folder: Path) -> dict[str, bytes]:
    """Return the bytes of every file of a folder."""
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def total(rows: list[dict[str, str]], column: str) -> int:
    """Add up a column of whole numbers."""
    return sum(int(row[column]) for row in rows)
