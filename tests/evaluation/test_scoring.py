"""Whole evaluations of small logs."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from mpap_cli.errors import UsageError
from mpap_cli.evaluation.baselines import BASELINES
from mpap_cli.evaluation.protocols import PROTOCOLS
from mpap_cli.evaluation.scoring import Evaluation, Variant, evaluate_all
from mpap_cli.evaluation.sheets import Question
from mpap_cli.evaluation.targets import parse_target
from mpap_cli.observations import ObservedLog
from mpap_cli.params import Settings, make_settings
from mpap_cli.systems.collision import CollisionModel

MakeLog = Callable[..., ObservedLog]
LearnLogs = Callable[[Settings, Sequence[ObservedLog]], CollisionModel]
PAPER = make_settings("paper", {"resamples": "20"})


@pytest.fixture
def logs(make_log: MakeLog) -> tuple[ObservedLog, ...]:
    """Return three short logs with two presses each."""
    return tuple(make_log(f"log{i}", 2, i) for i in range(3))


def tables(found: Evaluation) -> tuple[object, ...]:
    """Return every row of every table."""
    auc = [one.row for one in found.marks]
    roc = [row for one in found.marks for row in one.roc_rows()]
    return auc, roc, list(found.timeline.rows()), list(found.timeline.press_rows())


def test_rows_are_the_variants_then_the_baselines(
    logs: tuple[ObservedLog, ...], settings: Settings
) -> None:
    """First what was asked, then as learnt, then the five baselines, all scored alike."""
    variants = [Variant("mpap", PAPER), Variant("mpap as learnt", settings)]

    found = evaluate_all(Question(logs=logs), variants)

    rows = [one.row for one in found.marks]
    assert [row.method for row in rows] == ["mpap", "mpap as learnt", *BASELINES]
    assert found.protocol == "leave-one-log-out"
    assert [row.feature for row in rows[:2]] == ["global-diff", "inverse-min"]
    for row in rows:
        assert row.auc is not None
        assert 0 <= row.auc <= 1
        assert (row.positives, row.negatives, row.presses, row.logs) == (42, 408, 6, 3)
    assert rows[1].auc is not None
    assert rows[1].auc > 0.9


def test_same_question_gives_the_same_tables(
    logs: tuple[ObservedLog, ...], settings: Settings
) -> None:
    """Every row of every table is equal the second time."""
    question = Question(logs=logs[:1], target=parse_target("onset"))

    first = tables(evaluate_all(question, [Variant("mpap", settings)]))
    second = tables(evaluate_all(question, [Variant("mpap", settings)]))

    assert first == second


@pytest.mark.parametrize("protocol", [name for name in PROTOCOLS if name != "given-model"])
def test_every_protocol_says_something_of_every_scan(
    logs: tuple[ObservedLog, ...], settings: Settings, protocol: str
) -> None:
    """One row of the timeline a scan, one row of presses a press, an area."""
    groups = ("x", "y", "y") if protocol == "leave-one-group-out" else None
    question = Question(logs=logs, protocol=protocol, groups=groups)

    found = evaluate_all(question, [Variant("mpap", settings)], baselines=False)

    timeline = list(found.timeline.rows())
    presses = list(found.timeline.press_rows())
    assert found.marks[0].row.auc is not None
    assert found.timeline.held_out == (protocol != "in-sample")
    assert len(timeline) == 450
    assert len(presses) == 6
    assert timeline[150].log_index == 1
    assert timeline[150].time_s == 0
    assert sum(row.truth or 0 for row in timeline) == 42
    assert [row.start_s for row in presses[:2]] == [10, 25]


def test_timeline_agrees_with_itself(logs: tuple[ObservedLog, ...], settings: Settings) -> None:
    """Predicted scans reach the threshold; leads are zero exactly where missed."""
    question = Question(logs=logs, target=parse_target("early:1"), threshold=0.1)

    timeline = evaluate_all(question, [Variant("mpap", settings)], baselines=False).timeline

    for row in timeline.rows():
        assert row.p_collision is not None
        assert row.predicted == int(row.p_collision >= 0.1)
    found = list(timeline.press_rows())
    assert timeline.summary.judged == 6
    assert timeline.summary.announced == sum(row.predicted == 1 for row in found)
    assert timeline.summary.announced > 3
    assert timeline.summary.median_lead_s == np.median([row.lead_s for row in found])


def test_log_without_bumper_is_predicted_but_not_scored(
    make_log: MakeLog, settings: Settings
) -> None:
    """No area and no probability, but clusters and what is new."""
    question = Question(logs=(make_log(bumper=False),))

    found = evaluate_all(question, [Variant("mpap", settings)])

    rows = list(found.timeline.rows())
    assert found.reason == "no positive scan for target contact"
    assert all(one.row.auc is None for one in found.marks)
    assert rows[0].truth is None
    assert rows[0].p_collision is None
    assert rows[0].predicted is None
    assert rows[0].cluster is not None


def test_log_without_scans_gives_empty_tables(make_log: MakeLog, settings: Settings) -> None:
    """Nothing to see is no failure."""
    silent = replace(make_log(), blocks=lambda: iter(()))

    found = evaluate_all(Question(logs=(silent,)), [Variant("mpap", settings)])

    assert list(found.timeline.rows()) == []
    assert len(list(found.timeline.press_rows())) == 4
    assert found.marks[0].row.meta_points == 0


def test_given_model_is_scored_as_it_is(
    logs: tuple[ObservedLog, ...], settings: Settings, learn_logs: LearnLogs
) -> None:
    """One fold; baselines learn from the model's logs, without them only the range remains."""
    model = learn_logs(settings, logs[:2])
    alone = Question(logs=logs[2:], model=model)
    beside = replace(alone, model_logs=logs[:2])

    without = evaluate_all(alone, [Variant("mpap", settings)])
    found = evaluate_all(beside, [Variant("mpap", settings)])

    assert [one.row.method for one in without.marks] == [
        "mpap",
        "nearest-range",
        "nearest-range-1s",
    ]
    assert without.marks[1].row.auc is not None
    assert without.marks[1].row.brier is None
    assert [one.row.method for one in found.marks] == ["mpap", *BASELINES]
    assert found.protocol == "given-model"
    assert found.models == (model,)
    for one in found.marks:
        assert one.row.auc is not None
        assert one.row.auc_in_sample is None
        assert one.row.folds_scored == 1


def test_given_model_knows_its_own_warning_time(
    logs: tuple[ObservedLog, ...], settings: Settings, learn_logs: LearnLogs
) -> None:
    """What it did not count cannot be asked of it; one pair of counts serves all times."""
    robust = Question(
        logs=logs[2:], target=parse_target("early:3"), model=learn_logs(settings, logs[:1])
    )
    paper = replace(robust, model=learn_logs(PAPER, logs[:1]))

    same = replace(robust, target=parse_target("early:1"))

    with pytest.raises(UsageError, match="early:3: the model counted early:1"):
        evaluate_all(robust, [Variant("mpap", settings)])
    of_paper = evaluate_all(paper, [Variant("mpap", PAPER)], baselines=False)
    of_robust = evaluate_all(same, [Variant("mpap", settings)], baselines=False)

    assert of_paper.marks[0].row.target == "early:3"
    assert of_robust.marks[0].row.target == "early:1"


@pytest.mark.parametrize(
    ("target", "truth", "scored"),
    [("contact", "scan", False), ("onset", "scan", False), ("early:1", "scan (circular)", True)],
)
def test_presses_made_from_scans_are_marked(
    logs: tuple[ObservedLog, ...], settings: Settings, target: str, truth: str, scored: bool
) -> None:
    """Contact is not scored against the scan itself; a warning is, and is marked."""
    question = Question(logs=logs, target=parse_target(target), truth_name="scan")

    row = evaluate_all(question, [Variant("mpap", settings)], baselines=False).marks[0].row

    assert row.truth == truth
    assert (row.auc is not None) == scored
