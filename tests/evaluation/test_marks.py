"""Every area that is empty is empty for a reason."""

from dataclasses import fields, replace

import numpy as np
import pytest

from mpap_cli.evaluation.marks import Asked, Marks, Name, Outcome, mark
from mpap_cli.evaluation.observing import ScanRows
from mpap_cli.evaluation.operating import join_logs
from mpap_cli.evaluation.protocols import FoldPlan
from mpap_cli.evaluation.reasons import CIRCULAR
from mpap_cli.evaluation.rows import (
    AucRow,
    DifferenceRow,
    OperatingRow,
    PressRow,
    RocRow,
    TimelineRow,
)
from mpap_cli.evaluation.sheets import Sheet
from mpap_cli.params import EvaluationParams

# 20 scans: ten in each of two logs, the last four of each in contact.
LOG_INDEX = np.repeat([0, 1], 10)
TRUTH = np.tile(np.array([0] * 6 + [1] * 4, dtype=np.int8), 2)
SCORE = np.tile(np.arange(10) / 10, 2)


def sheet_of(
    truth: list[int] | None = None,
    plan: FoldPlan | None = None,
    labels: list[int] | None = None,
    seen: list[int] | None = None,
) -> Sheet:
    """Make a sheet of two logs, left out in turn."""
    true = TRUTH if truth is None else np.array(truth, dtype=np.int8)
    learnt = TRUTH if labels is None else np.array(labels, dtype=np.int8)
    both = FoldPlan("leave-one-log-out", 2, fold_of_log=np.array([0, 1]))
    used = both if plan is None else plan
    stamps_ns = np.tile(np.arange(10), 2)
    rows = ScanRows(
        LOG_INDEX, stamps_ns, np.zeros((20, 2), dtype=np.float32), np.zeros(20, dtype=np.float32)
    )
    return Sheet(
        rows=rows,
        labels=np.stack([learnt] * 3, axis=1),
        truth=true,
        truth_visible=true if seen is None else np.array(seen, dtype=np.int8),
        folds=used.place(LOG_INDEX, stamps_ns),
        unit=LOG_INDEX,
        n_units=2,
        unit_kind="logs",
        protocol=used.protocol,
        protocol_reason="",
        n_presses=2,
        n_visible=2 if seen is None else 1,
        announcing=join_logs(LOG_INDEX, stamps_ns, [(), ()], [(), ()]),
    )


ASKED = Asked(
    target="contact",
    truth="bumper",
    pair=0,
    n_logs=2,
    circular=False,
    params=EvaluationParams(resamples=20),
    seed=0,
)


def marked(sheet: Sheet, *, circular: bool = False) -> Marks:
    """Mark the scores above."""
    asked = replace(ASKED, circular=circular)
    outcome = Outcome(SCORE.copy(), SCORE.copy())
    return mark(Name(method="mpap"), asked, sheet, (outcome, outcome))


def test_row_of_two_good_folds() -> None:
    """All pairs are in order: areas of 1, an interval, counts, calibration."""
    found = marked(sheet_of())

    row = found.row
    assert (row.auc, row.auc_low, row.auc_high, row.auc_per_log) == (1, 1, 1, 1)
    assert (row.folds_scored, row.auc_in_sample, row.average_precision) == (2, 1, 1)
    assert (row.positives, row.negatives, row.presses, row.logs) == (8, 12, 2, 2)
    assert row.brier == pytest.approx(np.mean((SCORE - TRUTH) ** 2))
    assert found.reason == ""
    assert {corner.threshold for corner in found.roc_rows()} == {None}


@pytest.mark.parametrize(
    ("sheet", "reason"),
    [
        (sheet_of(truth=[0] * 20), "no positive scan for target contact"),
        (sheet_of(truth=[1] * 20), "no negative scan for target contact"),
        (sheet_of(plan=FoldPlan("blocked", 0, reason="one press only")), "one press only"),
        (sheet_of(labels=[0] * 20), "no fold has both classes to learn from"),
        (sheet_of(truth=[0] * 10 + [1] * 10), "no fold has both classes to score"),
    ],
)
def test_empty_area_has_a_reason(sheet: Sheet, reason: str) -> None:
    """No area, no interval and no curve, and one sentence that says why."""
    found = marked(sheet)

    assert found.row.auc is None
    assert found.row.auc_low is None
    assert found.row.folds_scored == 0
    assert found.reason == reason
    assert list(found.roc_rows()) == []


def test_truth_made_from_the_scan_is_not_scored() -> None:
    """It would be circular; the probabilities are still compared with it."""
    found = marked(sheet_of(), circular=True)

    assert found.row.auc is None
    assert found.row.auc_in_sample is None
    assert found.reason == CIRCULAR
    assert found.row.brier is not None


def test_one_press_leaves_the_in_sample_area() -> None:
    """Nothing can be held out, but learning and scoring the same scans still gives a number."""
    found = marked(sheet_of(plan=FoldPlan("blocked", 0, reason="one press only")))

    assert found.row.auc is None
    assert found.row.auc_in_sample == 1
    assert (found.row.positives, found.row.negatives) == (8, 12)


def test_what_nobody_saw_is_neither_positive_nor_negative() -> None:
    """Without the press of the second log its positives are out, and all else stays."""
    score = SCORE.copy()
    score[16:] = 0
    seen = [*TRUTH[:10].tolist(), *[0] * 6, *[-1] * 4]
    outcome = Outcome(score, score)

    row = mark(Name(method="mpap"), ASKED, sheet_of(seen=seen), (outcome, outcome)).row

    assert (row.presses, row.visible_presses) == (2, 1)
    assert row.auc == pytest.approx((24 + 2) / 48)
    assert row.auc_visible == 1
    assert row.auc_per_log == pytest.approx((1 + 2 / 24) / 2)
    assert row.auc_visible_per_log == 1
    assert (row.positives, row.negatives) == (8, 12)


def test_single_model_keeps_its_thresholds() -> None:
    """The rows of the curve begin above every score."""
    found = marked(sheet_of(plan=FoldPlan("in-sample", 1)))

    thresholds = [corner.threshold for corner in found.roc_rows()]
    assert thresholds[0] == np.inf
    assert thresholds[1:] == sorted(set(SCORE.tolist()), reverse=True)


@pytest.mark.parametrize(
    ("kind", "columns"),
    [
        (
            AucRow,
            (
                "method, feature, bins, profile, readout, target, protocol, truth, auc, auc_low, "
                "auc_high, auc_per_log, folds_scored, auc_in_sample, average_precision, brier, "
                "brier_skill, ece, positives, negatives, presses, logs, clusters, meta_points, "
                "auc_per_log_low, auc_per_log_high, visible_presses, auc_visible, "
                "auc_visible_low, auc_visible_high, auc_visible_per_log, auc_visible_per_log_low, "
                "auc_visible_per_log_high, calibration_slope, calibration_intercept"
            ),
        ),
        (
            DifferenceRow,
            (
                "method, feature, bins, profile, against, against_feature, against_bins, "
                "against_profile, target, protocol, truth, scored, logs, diff_per_log, "
                "diff_per_log_low, diff_per_log_high, diff, diff_low, diff_high"
            ),
        ),
        (
            OperatingRow,
            (
                "method, feature, bins, profile, target, protocol, threshold, presses, announced, "
                "recall, median_lead_s, visible_presses, visible_announced, visible_recall, "
                "visible_median_lead_s, false_alarms_per_min, alarm_share"
            ),
        ),
        (RocRow, "method, feature, bins, profile, target, protocol, threshold, fpr, tpr"),
        (
            TimelineRow,
            (
                "log, log_index, time_s, stamp_ns, cluster, p_cluster, p_collision, predicted, "
                "truth, distance, novel, alarm"
            ),
        ),
        (PressRow, "log, log_index, start_s, end_s, predicted, lead_s, visible, alarm_lead_s"),
    ],
)
def test_columns_stand_in_their_order(kind: type, columns: str) -> None:
    """The fields of the rows are the columns of the tables."""
    names = [item.name for item in fields(kind)]

    assert names == columns.split(", ")
