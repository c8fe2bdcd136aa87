"""Rows of the tables of an evaluation: the fields are the columns, in order.

None stands for an empty cell; flags are 0 or 1; times in ``_s`` count from the first
message of the log.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class AucRow:
    """One method under one target and protocol (a row of auc.csv; Table 4).

    ``visible`` columns leave out the presses before which nothing near was seen; the mean
    per log is over the logs that hold both classes; slope and intercept are those of the
    logistic recalibration.
    """

    method: str
    feature: str | None
    bins: int | None
    profile: str | None
    readout: str | None
    target: str
    protocol: str
    truth: str
    auc: float | None
    auc_low: float | None
    auc_high: float | None
    auc_per_log: float | None
    folds_scored: int
    auc_in_sample: float | None
    average_precision: float | None
    brier: float | None
    brier_skill: float | None
    ece: float | None
    positives: int
    negatives: int
    presses: int
    logs: int
    clusters: int | None
    meta_points: int | None
    auc_per_log_low: float | None
    auc_per_log_high: float | None
    visible_presses: int
    auc_visible: float | None
    auc_visible_low: float | None
    auc_visible_high: float | None
    auc_visible_per_log: float | None
    auc_visible_per_log_low: float | None
    auc_visible_per_log_high: float | None
    calibration_slope: float | None
    calibration_intercept: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class DifferenceRow:
    """Area of the first method less that of another, ``against`` (a row of differences.csv).

    ``logs`` hold both classes for both methods. ``diff_per_log`` is the mean over them,
    ``diff`` that of the areas pooled within each model; both methods are resampled alike.
    """

    method: str
    feature: str | None
    bins: int | None
    profile: str | None
    against: str
    against_feature: str | None
    against_bins: int | None
    against_profile: str | None
    target: str
    protocol: str
    truth: str
    scored: str
    logs: int
    diff_per_log: float | None
    diff_per_log_low: float | None
    diff_per_log_high: float | None
    diff: float | None
    diff_low: float | None
    diff_high: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingRow:
    """What one threshold of one method announces (a row of operating.csv).

    A missed press counts as a lead of 0 s; ``alarm_share`` is the share of the time outside
    contact in which a collision is predicted.
    """

    method: str
    feature: str | None
    bins: int | None
    profile: str | None
    target: str
    protocol: str
    threshold: float
    presses: int
    announced: int
    recall: float | None
    median_lead_s: float | None
    visible_presses: int
    visible_announced: int
    visible_recall: float | None
    visible_median_lead_s: float | None
    false_alarms_per_min: float | None
    alarm_share: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RocRow:
    """One corner of a ROC curve (a row of roc.csv; Fig. 10).

    ``threshold`` is None where the curves of several models were averaged: no single
    threshold leads to such a point.
    """

    method: str
    feature: str | None
    bins: int | None
    profile: str | None
    target: str
    protocol: str
    threshold: float | None
    fpr: float
    tpr: float


@dataclass(frozen=True, slots=True, kw_only=True)
class TimelineRow:
    """One scan as the method of the first row sees it (a row of timeline.csv; Fig. 9)."""

    log: str
    log_index: int
    time_s: float
    stamp_ns: int
    cluster: int | None
    p_cluster: float | None
    p_collision: float | None
    predicted: int | None
    truth: int | None
    distance: float | None
    novel: int | None
    alarm: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class PressRow:
    """One press and how early it was announced (a row of presses.csv).

    ``visible``: something near was seen ahead in the second before it; ``alarm_lead_s`` is
    the lead of the alarm of profile robust.
    """

    log: str
    log_index: int
    start_s: float
    end_s: float
    predicted: int | None
    lead_s: float | None
    visible: int | None
    alarm_lead_s: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionRow:
    """What the robot would have done at one image (a row of decisions.csv; section 4.2.6).

    ``nearest_ahead_m`` is the nearest range within 20 degrees of straight ahead in the scan
    of that moment, None without one.
    """

    log: str
    log_index: int
    time_s: float
    stamp_ns: int
    action: str
    obstacle_patches: int
    unknown_patches: int
    nearest_ahead_m: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class PatchRow:
    """One patch of an image (a row of patches.csv); rows and columns from the top left."""

    log: str
    log_index: int
    stamp_ns: int
    row: int
    column: int
    cluster: int | None
    p_obstacle: float | None
    unknown: int
