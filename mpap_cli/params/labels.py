"""Settings of presses, labels, probabilities and their scores (sections 2.3, 4.1, 5.2)."""

import math
from dataclasses import dataclass

from mpap_cli.params.checks import (
    MOST_COUNT,
    check_choices,
    require,
    require_seconds,
    setting,
)

READOUTS = ("exemplar", "cluster", "metapoint", "kernel")
TARGETS = ("contact", "onset", "early")
MOST_RESAMPLES = 100_000
MOST_FOLDS = 1000
HALF_TURN_DEG = 180.0

_MOST_SIGNS = 500
_REPEATS = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class BumperParams:
    """How bumper messages become presses (sections 4.1 and 5.3)."""

    bump_merge: float = setting(0.0, "ours", "join presses closer than that many seconds")
    bump_hold: float = setting(
        0.25, "ours", "seconds a touch lasts where only touches are sent (pulse)"
    )
    bump_max_press: float | None = setting(
        None, "ours", "longest press in seconds (none: until the release)"
    )
    bump_ignore: str = setting(
        "ground|floor|terrain|plane", "ours", "simulated contacts with such names do not count"
    )

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        require_seconds("bump-merge", self.bump_merge, zero=True)
        require_seconds("bump-hold", self.bump_hold)
        if self.bump_max_press is not None:
            require_seconds("bump-max-press", self.bump_max_press)
        shown = self.bump_ignore[:_MOST_SIGNS]
        wanted = "words joined by |, without ( ) and with two of * + ? { at most in each"
        require(_is_quick(self.bump_ignore), "bump-ignore", shown, wanted)


def _is_quick(pattern: str) -> bool:
    """Whether no name can keep a search busy: nothing in it is tried over and over again."""
    repeats = [sum(map(word.count, "*+?{")) for word in pattern.split("|")]
    return len(pattern) <= _MOST_SIGNS and "(" not in pattern and max(repeats) <= _REPEATS


@dataclass(frozen=True, slots=True, kw_only=True)
class PropertyParams:
    """How labels become probabilities (sections 2.3 and 4.1)."""

    learn_target: str = setting(
        "onset",
        "4.1",
        "labels that are counted: all pressed scans, or onsets",
        ("contact", "onset"),
    )
    readout: str = setting("kernel", "4.2.5", "where a probability is read", READOUTS)
    kernel_k: int = setting(20, "4.2.5", "kernel: nearest meta-points that are asked")
    prior_counts: float = setting(2.0, "ours", "kernel: pseudo-counts at the base rate")
    range_share: float = setting(
        0.5, "ours", "kernel: share of the curves over the nearest ranges of inverse-min (0: none)"
    )
    metapoint_prior: float = setting(4.0, "ours", "metapoint: pseudo-counts at the cluster's rate")
    alarm_lift: float = setting(
        2.5, "ours", "robust: an alarm begins where the odds are that many times those on the whole"
    )
    alarm_share: float = setting(
        0.05, "ours", "robust: or as high as at that share of what was learnt, if that is lower"
    )
    alarm_release: float = setting(
        0.5, "ours", "robust: it ends where they were below that share of it"
    )
    alarm_hold_s: float = setting(2.0, "ours", "robust: for that many seconds")
    onset_s: float = setting(1.0, "ours", "seconds of a press that count as its onset")
    release_s: float = setting(1.0, "ours", "onset: seconds without label after a release")
    early_s: float = setting(1.0, "ours", "early: a press begins within that many seconds")

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        check_choices(self)
        require(1 <= self.kernel_k <= MOST_COUNT, "kernel-k", self.kernel_k, "1 or more")
        require(self.prior_counts > 0, "prior-counts", self.prior_counts, "more than 0")
        require(0 <= self.range_share <= 1, "range-share", self.range_share, "0 to 1")
        require(self.metapoint_prior >= 0, "metapoint-prior", self.metapoint_prior, "0 or more")
        lift, release = self.alarm_lift, self.alarm_release
        require(0 < lift < math.inf, "alarm-lift", lift, "more than 0")
        require(0 <= self.alarm_share < 1, "alarm-share", self.alarm_share, "0 to below 1")
        require(0 < release <= 1, "alarm-release", release, "more than 0, at most 1")
        require_seconds("alarm-hold-s", self.alarm_hold_s, zero=True)
        require_seconds("onset-s", self.onset_s)
        require_seconds("release-s", self.release_s, zero=True)
        require_seconds("early-s", self.early_s)


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationParams:
    """How predictions are scored (section 5.2)."""

    folds: int = setting(5, "ours", "blocked: time blocks of a log, at most one per press")
    guard_s: float = setting(5.0, "ours", "blocked: seconds left out beside a block")
    resamples: int = setting(1000, "ours", "bootstrap resamples of an interval")
    visible_m: float = setting(
        0.6, "ours", "a press with a return nearer than that ahead before it is visible"
    )
    visible_margin_m: float = setting(
        0.2, "ours", "or that much beyond the lower quartile at presses of such a scanner"
    )
    visible_deg: float = setting(45.0, "ours", "visible: degrees to either side of straight ahead")

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        require(2 <= self.folds <= MOST_FOLDS, "folds", self.folds, f"2 to {MOST_FOLDS:,}")  # noqa: PLR2004
        require_seconds("guard-s", self.guard_s, zero=True)
        require(
            10 <= self.resamples <= MOST_RESAMPLES,  # noqa: PLR2004
            "resamples",
            self.resamples,
            f"10 to {MOST_RESAMPLES:,}",
        )
        require(0 < self.visible_m < math.inf, "visible-m", self.visible_m, "more than 0")
        require(
            0 <= self.visible_margin_m < math.inf,
            "visible-margin-m",
            self.visible_margin_m,
            "0 or more",
        )
        require(
            0 < self.visible_deg <= HALF_TURN_DEG,
            "visible-deg",
            self.visible_deg,
            f"more than 0, at most {HALF_TURN_DEG:g}",
        )
