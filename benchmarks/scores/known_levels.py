"""Known levels: every method on every target, by one definition.

``python benchmarks/scores/known_levels.py LOG... [--groups folder|REGEX|FILE.csv]``. Each log is
scored by models that learnt from the other groups (without groups: from the other logs).
Areas are told with 95 % intervals of a bootstrap over logs, and again without the presses
before which nothing near was seen; differences are paired log by log. The numbers are those
of auc.csv, differences.csv and operating.csv of ``mpap evaluate``.
"""

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from mpap_cli.commands.evaluating.observed import observe_logs
from mpap_cli.commands.inputs.progress import no_progress
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.errors import MpapError
from mpap_cli.evaluation.areas import Areas
from mpap_cli.evaluation.differences import difference
from mpap_cli.evaluation.groups import group_names
from mpap_cli.evaluation.marks import Marks
from mpap_cli.evaluation.operating import ALARM_SHARE, FALSE_ALARMS_PER_MIN, most_recall
from mpap_cli.evaluation.scoring import Evaluation, Variant, evaluate_all
from mpap_cli.evaluation.sheets import Question
from mpap_cli.evaluation.targets import parse_target
from mpap_cli.observations import ObservedLog
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.score_lines import Auc, auc_text, interval_text, score_text
from mpap_cli.outputs.text_table import aligned
from mpap_cli.params import PAPER_FEATURES, make_settings

TARGETS = ("contact", "onset", "early:1")
BINS = (6, 12)


def main(words: Sequence[str]) -> int:
    """Score the logs and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("logs", nargs="+", metavar="LOG")
    parser.add_argument("--groups", metavar="folder|REGEX|FILE.csv")
    asked = parser.parse_args(words)
    keep_kernels_writable()
    try:
        with (
            tempfile.TemporaryDirectory(prefix="mpap-levels-") as folder,
            ResultsFolder(Path(folder), "levels") as never_committed,
            one_thread_each(),
        ):
            selection = LogSelection(logs=tuple(asked.logs))
            read = observe_logs(selection, make_settings(), never_committed, 1, no_progress)
            groups = group_names(read.logs, asked.groups) if asked.groups else None
            found = {target: score(read.logs, groups, target) for target in TARGETS}
    except MpapError as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return error.exit_code
    print("\n".join(page(found)))
    return read.exit_code


def variants() -> list[Variant]:
    """Return profile robust, and every feature of the paper with its numbers of bins."""
    paper = [
        Variant(f"paper {feature}/{bins}", make_settings("paper", values))
        for feature in PAPER_FEATURES
        for bins in BINS
        for values in ({"feature": feature, "bins": str(bins)},)
    ]
    return [Variant("robust", make_settings()), *paper]


def score(logs: tuple[ObservedLog, ...], groups: tuple[str, ...] | None, target: str) -> Evaluation:
    """Score every method on one target."""
    question = Question(
        logs=logs,
        target=parse_target(target),
        protocol="leave-one-group-out" if groups else "leave-one-log-out",
        groups=groups,
    )
    return evaluate_all(question, variants())


def page(found: dict[str, Evaluation]) -> Iterator[str]:
    """Yield the lines of all tables."""
    row = found[TARGETS[0]].marks[0].row
    yield f"{row.logs} logs, {row.presses} presses, protocol {row.protocol}, truth: {row.truth}"
    yield from area_table("all presses", found, lambda marks: marks.areas)
    yield from area_table("visible presses", found, lambda marks: marks.visible)
    yield from table("Brier skill, calibration slope, intercept", found, probability_cell)
    title = (
        f"announced of the visible presses, of all, median lead in seconds (missed: 0), at the "
        f"best threshold on these scores with fewer than {FALSE_ALARMS_PER_MIN:g} false alarm a "
        f"minute, alarmed less than {ALARM_SHARE:.0%} of the time"
    )
    yield from table(title, found, alarm_cell)


def area_table(
    title: str, found: dict[str, Evaluation], areas_of: Callable[[Marks], Areas]
) -> Iterator[str]:
    """Yield the areas, and how much better profile robust is."""
    name = f"{title}: mean AUC of the logs with both classes"
    yield from table(name, found, lambda _, one: mean_cell(areas_of(one)))
    name = f"{title}: profile robust less the method, mean over the same logs"
    yield from table(name, found, lambda first, one: gain_cell(areas_of(first), areas_of(one)))
    name = f"{title}: AUC pooled within each model"
    yield from table(name, found, lambda _, one: pooled_cell(areas_of(one)))


def table(
    title: str, found: dict[str, Evaluation], cell: Callable[[Marks, Marks], str]
) -> Iterator[str]:
    """Yield a title and a table of methods and targets; a cell knows the first method too."""
    names = [one.row.method for one in found[TARGETS[0]].marks]
    columns = [
        [cell(evaluation.marks[0], one) for one in evaluation.marks]
        for evaluation in found.values()
    ]
    yield f"\n{title}"
    yield from aligned([("method", *found), *zip(names, *columns, strict=True)])


def mean_cell(areas: Areas) -> str:
    """Return the mean over logs, its interval and the number of logs."""
    return f"{auc_text(Auc(areas.per_log, *areas.per_log_interval()))} ({areas.n_logs})"


def gain_cell(first: Areas, other: Areas) -> str:
    """Return the difference per log, its interval and the number of logs."""
    if first is other:
        return "-"
    gain = difference(first, other)
    mean = "-" if gain.per_log is None else f"{gain.per_log:+.2f}"
    return f"{mean} {interval_text(Auc(gain.per_log, *gain.per_log_interval))} ({gain.logs})"


def pooled_cell(areas: Areas) -> str:
    """Return the pooled area and its interval."""
    return auc_text(Auc(areas.pooled, *areas.pooled_interval()))


def probability_cell(_: Marks, one: Marks) -> str:
    """Return whether probabilities mean what they say."""
    row = one.row
    return " ".join(
        score_text(value)
        for value in (row.brier_skill, row.calibration_slope, row.calibration_intercept)
    )


def alarm_cell(_: Marks, one: Marks) -> str:
    """Return what could be announced with few false alarms."""
    best = most_recall(one.points)
    if best is None:
        return "-"
    seen, every = best.visible, best.every
    lead = "-" if every.median_lead_s is None else f"{every.median_lead_s:.1f}"
    return f"{seen.announced}/{seen.judged} {every.announced}/{every.judged} {lead}"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
