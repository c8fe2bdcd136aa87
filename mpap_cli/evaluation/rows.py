"""Rows of the tables of an evaluation: the fields are the columns, in order.

None stands for an empty cell; flags are 0 or 1; times in ``_s`` count from the first
message of the log.
"""

from dataclasses import dataclass
from typing import Annotated

from mpap_cli.systems.columns import (
    Bins,
    Cluster,
    Feature,
    LogIndex,
    LogName,
    Method,
    Presses,
    Profile,
    Protocol,
    StampNs,
    Target,
    TimeS,
    Truth,
    VisiblePresses,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class AucRow:
    """One method under one target and protocol (a row of auc.csv; Table 4)."""

    method: Method
    feature: Feature
    bins: Bins
    profile: Profile
    readout: Annotated[str | None, "how a probability is read from the model (setting `readout`)"]
    target: Target
    protocol: Protocol
    truth: Truth
    auc: Annotated[float | None, "area under the ROC curve, pairs of scans within one model only"]
    auc_low: Annotated[float | None, "lower end of its 95 % interval"]
    auc_high: Annotated[float | None, "upper end of its 95 % interval"]
    auc_per_log: Annotated[float | None, "mean of the areas of the logs that hold both classes"]
    folds_scored: Annotated[int, "folds of the protocol that gave scores"]
    auc_in_sample: Annotated[float | None, "area where the same scans are learnt and scored"]
    average_precision: Annotated[float | None, "area under the curve of precision over recall"]
    brier: Annotated[float | None, "mean squared gap between probability and outcome"]
    brier_skill: Annotated[
        float | None, "1 less its ratio to that of the base rate; above 0 is better"
    ]
    ece: Annotated[float | None, "mean gap between probability and frequency over ten bins"]
    positives: Annotated[int, "scans with the target"]
    negatives: Annotated[int, "scans without it"]
    presses: Presses
    logs: Annotated[int, "logs that are scored"]
    clusters: Annotated[int | None, "clusters of the model of all scans"]
    meta_points: Annotated[int | None, "its meta-points"]
    auc_per_log_low: Annotated[float | None, "lower end of the 95 % interval of `auc_per_log`"]
    auc_per_log_high: Annotated[float | None, "upper end of it"]
    visible_presses: VisiblePresses
    auc_visible: Annotated[float | None, "`auc` without the scans of the other presses"]
    auc_visible_low: Annotated[float | None, "lower end of its 95 % interval"]
    auc_visible_high: Annotated[float | None, "upper end of it"]
    auc_visible_per_log: Annotated[
        float | None, "`auc_per_log` without the scans of the other presses"
    ]
    auc_visible_per_log_low: Annotated[float | None, "lower end of its 95 % interval"]
    auc_visible_per_log_high: Annotated[float | None, "upper end of it"]
    calibration_slope: Annotated[float | None, "slope of the logistic recalibration; 1 is right"]
    calibration_intercept: Annotated[float | None, "intercept of it; 0 is right"]


@dataclass(frozen=True, slots=True, kw_only=True)
class DifferenceRow:
    """Area of the first method less that of another, ``against`` (a row of differences.csv).

    Both methods are resampled alike.
    """

    method: Method
    feature: Feature
    bins: Bins
    profile: Profile
    against: Annotated[str, "method that it is compared with"]
    against_feature: Annotated[str | None, "feature of that"]
    against_bins: Annotated[int | None, "bins of that"]
    against_profile: Annotated[str | None, "profile of that"]
    target: Target
    protocol: Protocol
    truth: Truth
    scored: Annotated[str, "`all presses`, or `visible presses`: without those nobody could see"]
    logs: Annotated[int, "logs that hold both classes for both methods"]
    diff_per_log: Annotated[float | None, "mean over them of the first area less the other"]
    diff_per_log_low: Annotated[float | None, "lower end of its 95 % interval"]
    diff_per_log_high: Annotated[float | None, "upper end of it"]
    diff: Annotated[float | None, "difference of the areas pooled within each model"]
    diff_low: Annotated[float | None, "lower end of its 95 % interval"]
    diff_high: Annotated[float | None, "upper end of it"]


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingRow:
    """What one threshold of one method announces (a row of operating.csv)."""

    method: Method
    feature: Feature
    bins: Bins
    profile: Profile
    target: Target
    protocol: Protocol
    threshold: Annotated[float, "a collision is announced from this probability up"]
    presses: Presses
    announced: Annotated[int, "those that a run of predicted scans reaches"]
    recall: Annotated[float | None, "their share"]
    median_lead_s: Annotated[
        float | None, "median time from announcement to onset; 0 s for a missed press"
    ]
    visible_presses: VisiblePresses
    visible_announced: Annotated[int, "those of them that are announced"]
    visible_recall: Annotated[float | None, "their share"]
    visible_median_lead_s: Annotated[float | None, "median lead of visible presses"]
    false_alarms_per_min: Annotated[float | None, "alarms wholly outside contact, a minute"]
    alarm_share: Annotated[
        float | None, "share of the time outside contact in which a collision is predicted"
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class RocRow:
    """One corner of a ROC curve (a row of roc.csv; Fig. 10)."""

    method: Method
    feature: Feature
    bins: Bins
    profile: Profile
    target: Target
    protocol: Protocol
    threshold: Annotated[
        float | None, "probability of this corner; empty where curves of models were averaged"
    ]
    fpr: Annotated[float, "false positive rate"]
    tpr: Annotated[float, "true positive rate"]


@dataclass(frozen=True, slots=True, kw_only=True)
class TimelineRow:
    """One scan as the method of the first row sees it (a row of timeline.csv; Fig. 9)."""

    log: LogName
    log_index: LogIndex
    time_s: TimeS
    stamp_ns: StampNs
    cluster: Cluster
    p_cluster: Annotated[float | None, "probability of that cluster"]
    p_collision: Annotated[
        float | None, "probability of a collision; evaluate: of a model that never saw the scan"
    ]
    predicted: Annotated[int | None, "1 from `--threshold` up"]
    truth: Annotated[int | None, "1 in contact, empty where nobody knows"]
    distance: Annotated[float | None, "distance to the nearest exemplar"]
    novel: Annotated[int | None, "1 where that is further than a meta-point reaches"]
    alarm: Annotated[int | None, "1 while an alarm of profile robust lasts"]


@dataclass(frozen=True, slots=True, kw_only=True)
class PressRow:
    """One press and how early it was announced (a row of presses.csv)."""

    log: LogName
    log_index: LogIndex
    start_s: Annotated[float, "onset in seconds since the first message of the log"]
    end_s: Annotated[float, "release, likewise"]
    predicted: Annotated[int | None, "1 if it was announced at `--threshold`"]
    lead_s: Annotated[float | None, "seconds from the announcement to the onset"]
    visible: Annotated[int | None, "1 if something near was seen ahead in the second before it"]
    alarm_lead_s: Annotated[float | None, "the lead of the alarm of profile robust"]


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionRow:
    """What the robot would have done at one image (a row of decisions.csv; section 4.2.6)."""

    log: LogName
    log_index: LogIndex
    time_s: TimeS
    stamp_ns: StampNs
    action: Annotated[str, "`straight`, `rotate-left`, `rotate-right` or `stop`"]
    obstacle_patches: Annotated[int, "patches that are obstacles"]
    unknown_patches: Annotated[int, "patches like none learnt"]
    nearest_ahead_m: Annotated[
        float | None, "nearest range within 20 degrees of straight ahead in the scan of that moment"
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class PatchRow:
    """One patch of an image (a row of patches.csv); rows and columns from the top left."""

    log: LogName
    log_index: LogIndex
    stamp_ns: StampNs
    row: Annotated[int, "row of the patch, from the top, from 0"]
    column: Annotated[int, "column, from the left, from 0"]
    cluster: Cluster
    p_obstacle: Annotated[float | None, "probability that it is an obstacle"]
    unknown: Annotated[int, "1 if no exemplar lies within `eps`"]
