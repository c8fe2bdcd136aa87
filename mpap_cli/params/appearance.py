"""Settings of the appearance model: STRAP, obstacle labels, decisions (section 4.2)."""

from dataclasses import dataclass

from mpap_cli.params.checks import (
    MOST_COUNT,
    check_choices,
    require,
    require_seconds,
    setting,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class StrapParams:
    """Streaming affinity propagation on two scales (sections 3.3 and 4.2.3)."""

    eps: float = setting(0.27, "3.3", "fit radius: farther from every exemplar is an outlier")
    reservoir: int = setting(500, "4.2.3", "outliers kept before clusters are made anew")
    strap_window_s: float | None = setting(
        None, "3.3", "seconds after which a cluster counts half (none: counts are exact)"
    )
    weight_cap: int = setting(10, "3.3", "most that a cluster weighs when clusters are made anew")
    known_share: float = setting(
        0.005, "ours", "a place is known once outliers are a smaller share than that (0: never)"
    )
    noise_share: float = setting(
        0.03, "ours", "share of outliers that is noise in a known place: it calls for no rebuild"
    )
    strap_distortion: bool = setting(
        False, "3.3", "distortion lowers the preference of a cluster when clusters are made anew"
    )
    page_hinkley: bool = setting(
        False, "3.3", "a rise of the outlier share also makes clusters anew"
    )
    page_hinkley_delta: float = setting(0.005, "3.3", "rise of the share that is tolerated")
    page_hinkley_lambda: float = setting(10.0, "3.3", "sum of rises that is a change")

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        require(0 < self.eps <= 1, "eps", self.eps, "a distance above 0, at most 1")
        require(1 <= self.reservoir <= 10_000, "reservoir", self.reservoir, "1 to 10,000")  # noqa: PLR2004
        if self.strap_window_s is not None:
            require_seconds("strap-window-s", self.strap_window_s)
        require(1 <= self.weight_cap <= MOST_COUNT, "weight-cap", self.weight_cap, "1 or more")
        known, noise = self.known_share, self.noise_share
        require(0 <= known < 1, "known-share", known, "0 to below 1")
        require(known <= noise < 1, "noise-share", noise, "known-share to below 1")
        delta, most = self.page_hinkley_delta, self.page_hinkley_lambda
        require(0 <= delta <= 1, "page-hinkley-delta", delta, "0 to 1")
        require(0 < most <= MOST_COUNT, "page-hinkley-lambda", most, "more than 0")


@dataclass(frozen=True, slots=True, kw_only=True)
class ObstacleParams:
    """How patches get labels and probabilities, and what the robot decides (section 4.2)."""

    obstacle_labels: str = setting(
        "driven",
        "4.2.4",
        "what is no obstacle: floor that is driven over, or all patches while nothing is touched",
        ("driven", "plain"),
    )
    label_rows: str = setting(
        "all", "4.2.4", "rows of patches that a bump labels: all, or LO:HI counted from 0"
    )
    bump_image_s: float = setting(
        0.2, "4.2.4", "the image nearest to a bump counts if it is that near in seconds"
    )
    press_image_s: float = setting(
        1.0, "ours", "driven: seconds of a press whose images count, as with scans"
    )
    driven_before_s: float = setting(2.0, "ours", "driven: no press begins within these seconds")
    driven_after_s: float = setting(2.5, "ours", "driven: no press within the seconds before")
    driven_min_m: float = setting(
        0.1, "ours", "driven: odometry goes at least that far within driven-before-s"
    )
    driven_share: float = setting(
        0.5, "ours", "driven: odometry goes that share of the farthest it went so within a log"
    )
    neighbors: int = setting(50, "4.2.5", "nearest exemplars that are asked about a patch")
    patch_prior: float = setting(10.0, "ours", "kernel: pseudo-counts of a patch at the base rate")
    sighting_weight: float = setting(
        0.05, "ours", "kernel: share of a label for an obstacle that a patch without label is"
    )
    patch_threshold: float = setting(0.5, "4.2.5", "probability from which a patch is an obstacle")
    unknown: str = setting(
        "free", "4.2.6", "what an unknown patch is for the decision", ("free", "obstacle")
    )
    front_rows: int = setting(4, "4.2.6", "free patches ahead that are needed to go straight")
    side_rows: int = setting(
        2, "ours", "free patches that are needed in the columns beside those ahead"
    )

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        check_choices(self)
        require_seconds("bump-image-s", self.bump_image_s)
        require_seconds("press-image-s", self.press_image_s)
        require_seconds("driven-before-s", self.driven_before_s)
        require_seconds("driven-after-s", self.driven_after_s, zero=True)
        require(0 <= self.driven_min_m <= 100, "driven-min-m", self.driven_min_m, "0 to 100")  # noqa: PLR2004
        require(0 <= self.driven_share <= 1, "driven-share", self.driven_share, "0 to 1")
        require(1 <= self.neighbors <= 1000, "neighbors", self.neighbors, "1 to 1000")  # noqa: PLR2004
        share = self.patch_threshold
        require(0 <= share <= 1, "patch-threshold", share, "0 to 1")
        require(self.patch_prior > 0, "patch-prior", self.patch_prior, "more than 0")
        weight = self.sighting_weight
        require(0 <= weight <= 1, "sighting-weight", weight, "0 to 1")
        require(0 <= self.side_rows <= 144, "side-rows", self.side_rows, "0 to 144")  # noqa: PLR2004
        require(1 <= self.front_rows <= 144, "front-rows", self.front_rows, "1 to 144")  # noqa: PLR2004
        self.labelled_rows()

    def labelled_rows(self) -> tuple[int, int] | None:
        """Return the first row and the row behind the last that a bump labels; None: all.

        >>> ObstacleParams(label_rows="3:6").labelled_rows()
        (3, 6)
        """
        if self.label_rows == "all":
            return None
        low, colon, high = self.label_rows.partition(":")
        good = bool(colon) and low.isdecimal() and high.isdecimal() and int(low) < int(high) <= 144  # noqa: PLR2004
        require(good, "label-rows", self.label_rows, "all, or LO:HI with LO below HI")
        return int(low), int(high)
