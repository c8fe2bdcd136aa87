"""What evaluate prints."""

from dataclasses import replace

import pytest

from mpap_cli.evaluation.paper_tables import TABLE_4
from mpap_cli.outputs.evaluate_text import (
    Announced,
    BestBelow,
    EvaluateSummary,
    MethodRow,
    evaluate_text,
)
from mpap_cli.outputs.score_lines import (
    Against,
    Auc,
    Comparison,
    PerLog,
    Probabilities,
    VisibleScores,
    per_log_line,
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
        threshold=0.2,
        announced=9,
        presses=11,
        median_lead_s=0.4,
        visible_announced=9,
        visible=11,
        visible_median_lead_s=0.4,
        false_alarms_per_minute=0.8,
    ),
)
NEAREST = Against("nearest range ahead", Auc(0.05, -0.01, 0.12), 9)
FOREST = Against("random-forest", Auc(-0.1), 9)


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
        visible_announced=0,
        visible=0,
        visible_median_lead_s=None,
        false_alarms_per_minute=None,
    )

    text = evaluate_text(replace(SUMMARY, announced=announced))

    assert text.endswith("at p >= 0.5: 0 of 1 press announced\n")


def test_table_4_is_the_papers() -> None:
    """Five features by two sizes of bins; the paper's words on them hold."""
    assert len(TABLE_4) == 10
    assert max(TABLE_4.values(), key=lambda pair: pair[1]) == TABLE_4["max-value", 6]
    assert TABLE_4["mean-value", 6][1] < 0.7


def test_differences_are_told_against_each_method() -> None:
    """With sign and interval, and once over how many logs."""
    per_log = PerLog(Auc(0.9, 0.8, 0.95), 9, (NEAREST, FOREST))

    text = evaluate_text(replace(SUMMARY, per_log=per_log))

    assert (
        "\nmean AUC of 9 logs: 0.90 [.80,.95]; against nearest range ahead: +.05 [-.01,.12], "
        "random-forest: -.10 over 9 logs\n"
    ) in text


def test_other_logs_are_told_apart() -> None:
    """Where methods could be scored on other logs, each says on how many."""
    forest = replace(FOREST, logs=1)
    empty = replace(FOREST, difference=Auc())

    line = per_log_line(PerLog(Auc(0.9), 9, (NEAREST, forest, empty)))

    assert line == (
        "mean AUC of 9 logs: 0.90; against nearest range ahead: +.05 [-.01,.12] over 9 logs, "
        "random-forest: -.10 over 1 log"
    )


def test_a_difference_of_nothing_has_no_minus() -> None:
    """What rounds to 0 is written +.00."""
    line = per_log_line(PerLog(Auc(0.9), 5, (Against("k-means", Auc(-0.001), 5),)))

    assert line.endswith("k-means: +.00 over 5 logs")


@pytest.mark.parametrize("per_log", [PerLog(Auc(0.9), 1, (NEAREST,)), PerLog(Auc(), 0)])
def test_one_log_has_no_mean(per_log: PerLog) -> None:
    """Of one log the area itself stands in the table."""
    assert per_log_line(per_log) == ""


def test_visible_presses_have_a_line_of_their_own() -> None:
    """Pooled and log by log, with what they are."""
    per_log = PerLog(Auc(0.95), 8, (replace(NEAREST, logs=8),))
    visible = VisibleScores(1, Auc(0.92, 0.82, 0.97), per_log)

    text = evaluate_text(replace(SUMMARY, visible=visible))
    unscored = evaluate_text(replace(SUMMARY, visible=VisibleScores(0, Auc(), PerLog(Auc(), 0))))

    assert (
        "\nbefore 1 press something near was seen ahead; with these only: AUC 0.92 [.82,.97]; "
        "mean AUC of 8 logs: 0.95; against nearest range ahead: +.05 [-.01,.12] over 8 logs\n"
    ) in text
    assert "\nbefore 0 presses something near was seen ahead\n" in unscored


def test_what_could_be_seen_is_announced_apart() -> None:
    """The visible presses are told where there are others."""
    assert SUMMARY.announced is not None
    announced = replace(SUMMARY.announced, visible=10, visible_median_lead_s=0.5)

    text = evaluate_text(replace(SUMMARY, announced=announced))

    assert text.endswith(
        "at p >= 0.2: 9 of 11 presses announced, median lead 0.4 s, of 10 visible ones 9, "
        "median lead 0.5 s, 0.8 false alarms a minute\n"
    )


def test_the_best_threshold_says_that_it_was_chosen_afterwards() -> None:
    """It is no result, but what could have been; or nothing could."""
    assert SUMMARY.announced is not None
    best = BestBelow(1.0, 0.1, replace(SUMMARY.announced, threshold=0.12345))

    text = evaluate_text(replace(SUMMARY, best=best))
    none = evaluate_text(replace(SUMMARY, best=replace(best, announced=None)))

    assert (
        "at p >= 0.123: 9 of 11 presses announced, median lead 0.4 s, 0.8 false alarms a minute "
        "(the best on these scores with fewer than 1 false alarm a minute, alarmed less than "
        "10 % of the time)\n"
    ) in text
    assert none.endswith(
        "no threshold announces a press with fewer than 1 false alarm a minute, alarmed less "
        "than 10 % of the time\n"
    )


@pytest.mark.parametrize(
    ("found", "line"),
    [
        (
            Probabilities(0.21, 0.9, -0.1),
            "probabilities: Brier skill 0.21, calibration slope 0.90 (1 is right), intercept -0.10",
        ),
        (Probabilities(-0.5, None, None), "probabilities: Brier skill -0.50"),
    ],
)
def test_probabilities_are_told(found: Probabilities, line: str) -> None:
    """Skill, slope and intercept, as far as there are."""
    assert evaluate_text(replace(SUMMARY, probabilities=found)).endswith(f"{line}\n")


def test_one_class_has_no_probability_line() -> None:
    """Without skill nothing is told."""
    found = Probabilities(None, None, None)

    assert "probabilities" not in evaluate_text(replace(SUMMARY, probabilities=found))


def test_alarms_stand_before_the_threshold() -> None:
    """With how much of the time they last."""
    assert SUMMARY.announced is not None
    alarmed = replace(SUMMARY.announced, threshold=1.0, alarm_share=0.157)

    lines = evaluate_text(replace(SUMMARY, alarmed=alarmed)).splitlines()

    (line,) = [line for line in lines if line.startswith("alarms")]
    assert line.startswith("alarms: 9 of 11 presses announced, ")
    assert line.endswith("0.8 false alarms a minute, alarmed 16 % of the time")
    assert lines[lines.index(line) + 1].startswith("at p >= 0.2: ")
    assert evaluate_text(replace(SUMMARY, alarmed=replace(alarmed, alarm_share=None))) in "".join(
        f"{one}\n" for one in lines
    ).replace(", alarmed 16 % of the time", "")
