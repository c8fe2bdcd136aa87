"""What evaluate prints."""

from dataclasses import replace

import pytest

from mpap_cli.evaluation.paper_tables import TABLE_4
from mpap_cli.outputs.evaluate_text import (
    Announced,
    Auc,
    Comparison,
    EvaluateSummary,
    MethodRow,
    evaluate_text,
)

ROW = MethodRow(
    method="mpap global-diff/6",
    profile="paper",
    held_out=Auc(0.71, 0.6, 0.8),
    in_sample=0.9,
    paper=TABLE_4["global-diff", 6],
    clusters=24,
    meta_points=412,
)
SUMMARY = EvaluateSummary(
    feature="global-diff",
    bins=(6,),
    profile="paper",
    reason="because --feature was given",
    logs=2,
    scans=9640,
    positives=612,
    presses=11,
    truth="bumper",
    rows=(ROW,),
    comparisons=(
        Comparison("mpap as learnt (robust)", Auc(0.86, 0.8, 0.9)),
        Comparison("nearest range ahead", Auc(0.83)),
    ),
    protocol_detail="blocked, 5 folds, 5 s guard",
    announced=Announced(
        threshold=0.2, announced=9, presses=11, median_lead_s=0.4, false_alarms_per_minute=0.8
    ),
)


def test_print_out_is_laid_out_as_designed() -> None:
    """Every line is where the documents show it."""
    text = evaluate_text(SUMMARY)

    assert text == (
        "global-diff, 6 bins, profile paper (because --feature was given). "
        "2 logs, 9,640 scans, 612 in contact, 11 presses; truth: bumper\n"
        "method              profile  held-out AUC  [95 %]     in-sample AUC  paper's Table 4"
        "   clusters  meta-points\n"
        "mpap global-diff/6  paper    0.71          [.60,.80]  0.90           .90 in / .90 out"
        "  24        412\n"
        "for comparison: mpap as learnt (robust) 0.86 [.80,.90]; nearest range ahead 0.83\n"
        "held-out: every press scored by a model that never saw it (blocked, 5 folds, 5 s guard). "
        "in-sample: same scans learnt and scored; only this compares with the paper.\n"
        "at p >= 0.2: 9 of 11 presses announced, median lead 0.4 s, 0.8 false alarms a minute\n"
    )


def test_what_is_not_there_is_a_dash_or_no_line() -> None:
    """Without scores and comparisons cells are dashes, lines are left out, notes stay."""
    row = replace(
        ROW, held_out=Auc(), in_sample=float("nan"), paper=None, clusters=None, meta_points=None
    )
    note = "held-out AUC empty: one press only"

    text = evaluate_text(
        replace(SUMMARY, rows=(row,), comparisons=(), announced=None, protocol="", notes=(note,))
    )

    lines = text.splitlines()
    assert lines[2].split() == ["mpap", "global-diff/6", "paper", *"-" * 6]
    assert lines[-1] == note
    assert "for comparison" not in text
    assert "announced" not in text


def test_one_of_each_is_singular() -> None:
    """One log, one scan, one press."""
    text = evaluate_text(replace(SUMMARY, logs=1, scans=1, presses=1, bins=(1,)))

    assert "1 bin, " in text
    assert "1 log, 1 scan, 612 in contact, 1 press;" in text


def test_all_features_have_one_heading() -> None:
    """With all features and several bins the heading says so."""
    text = evaluate_text(replace(SUMMARY, feature="all", bins=(6, 12), rows=(ROW, ROW)))

    assert text.startswith("all features, 6 and 12 bins, profile paper")
    assert len(text.splitlines()) == 7


@pytest.mark.parametrize(
    ("target", "words"),
    [
        ("onset", "612 at the onset of a press, 11 presses; truth: bumper; target: onset"),
        ("early:2", "612 shortly before a press, 11 presses; truth: bumper; target: early:2"),
    ],
)
def test_other_targets_are_named(target: str, words: str) -> None:
    """What counts as positive is said where it is not contact."""
    assert words in evaluate_text(replace(SUMMARY, target=target))


@pytest.mark.parametrize(
    ("protocol", "words"),
    [
        ("leave-one-log-out", "held-out: every log scored by a model that never saw it"),
        ("leave-one-group-out", "held-out: every group of logs scored by a model that never"),
        ("prequential", "held-out: every scan scored before the model learnt it"),
        ("given-model", "given model: scores of that one model"),
    ],
)
def test_protocol_is_told(protocol: str, words: str) -> None:
    """Each protocol has its sentence; in-sample is only spoken of where it is printed."""
    row = replace(ROW, in_sample=None)

    text = evaluate_text(replace(SUMMARY, protocol=protocol, protocol_detail="", rows=(row,)))

    assert words in text
    assert "in-sample:" not in text


def test_in_sample_is_no_held_out() -> None:
    """The protocol in-sample does not claim anything held out."""
    text = evaluate_text(replace(SUMMARY, protocol="in-sample"))

    assert "held-out: " not in text
    assert "in-sample: same scans" in text


def test_announcement_may_have_no_lead() -> None:
    """No press announced has no lead, no clear minute no false alarms."""
    announced = Announced(
        threshold=0.5,
        announced=0,
        presses=1,
        median_lead_s=None,
        false_alarms_per_minute=None,
    )

    text = evaluate_text(replace(SUMMARY, announced=announced))

    assert text.endswith("at p >= 0.5: 0 of 1 press announced\n")


def test_table_4_is_the_papers() -> None:
    """Five features by two sizes of bins; the paper's words on them hold."""
    assert len(TABLE_4) == 10
    assert max(TABLE_4.values(), key=lambda pair: pair[1]) == TABLE_4["max-value", 6]
    assert TABLE_4["mean-value", 6][1] < 0.7
