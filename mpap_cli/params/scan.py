"""Settings of the features of laser scans (section 4.1)."""

import math
from dataclasses import dataclass

from mpap_cli.params.checks import check_choices, require, require_seconds, setting

LONGEST_RANGE_M = 1e6

PAPER_FEATURES = ("min-value", "max-value", "mean-value", "global-diff", "seq-diff")
SCAN_FEATURE_NAMES = (*PAPER_FEATURES, "seq-diff-signed", "inverse-min")


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanParams:
    """How raw ranges are cleaned and where the bins lie (section 4.1)."""

    feature: str = setting("inverse-min", "4.1", "value of one bin of a scan", SCAN_FEATURE_NAMES)
    bins: int = setting(12, "5.2", "bins over the field of view")
    fov: str = setting(
        "profile", "5.2", "field of view in degrees: one width about forward, FROM,TO, or profile"
    )
    forward: str = setting(
        "tf", "ours", "direction of travel in the frame of the scanner: degrees, or from tf"
    )
    keep_scale: bool = setting(
        False, "eq. 7", "add a slack bin, so that equation 7 does not forget the scale"
    )
    max_range: float | None = setting(None, "5.2", "cap on ranges in metres (none: range_max)")
    no_return: str = setting(
        "max", "5.2", "beam without return: counts as range_max, or is left out", ("max", "drop")
    )
    near: str = setting(
        "min", "5.2", "beam nearer than range_min: range_min, or no return", ("min", "far")
    )
    zero: str = setting(
        "no-return", "5.2", "a range of 0: no return, or too near", ("no-return", "near")
    )
    lookback_s: float = setting(
        0.0, "ours", "minimum over that many seconds before the scan (0: off)"
    )
    near_cap_m: float = setting(1.0, "ours", "inverse-min: ranges above count as this")
    near_floor_m: float = setting(0.2, "ours", "inverse-min: ranges below count as this")
    ring_weight: float = setting(1.0, "ours", "inverse-min: weight of the nearest range all round")
    front_weight: float = setting(
        0.5, "ours", "inverse-min: weight of the nearest range, what lies behind stretched (0: off)"
    )
    rear_stretch: float = setting(
        3.0, "ours", "inverse-min: straight behind counts as that many times as far in that"
    )
    sector_weight: float = setting(0.5, "ours", "inverse-min: weight of the sectors")
    approach_weight: float = setting(
        0.3, "ours", "inverse-min: weight of the approach block (0: off)"
    )
    approach_s: float = setting(
        0.6, "ours", "inverse-min: seconds over which the approach is taken"
    )

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        check_choices(self)
        require(1 <= self.bins <= 360, "bins", self.bins, "1 to 360")  # noqa: PLR2004
        cap = self.max_range
        fits = cap is None or 0 < cap <= LONGEST_RANGE_M
        require(fits, "max-range", cap, f"metres above 0, at most {LONGEST_RANGE_M:g}")
        require_seconds("lookback-s", self.lookback_s, zero=True)
        require_seconds("approach-s", self.approach_s)
        floor, top = self.near_floor_m, self.near_cap_m
        require(0 < floor < top, "near-floor-m", floor, f"above 0, below near-cap-m {top}")
        weights = (self.ring_weight, self.front_weight, self.sector_weight, self.approach_weight)
        fits = min(weights) >= 0 and math.isfinite(sum(weights))
        require(fits, "ring-weight", weights, "weights of 0 or more")
        require(sum(weights[:3]) > 0, "ring-weight", weights, "one weight above 0")
        stretch = self.rear_stretch
        require(1 <= stretch < math.inf, "rear-stretch", stretch, "1 or more")
        self.fov_degrees()
        self.forward_rad()

    def forward_rad(self) -> float | None:
        """Return the direction of travel in radians; None: from tf.

        >>> ScanParams(forward="tf").forward_rad() is None
        True
        """
        if self.forward == "tf":
            return None
        try:
            degrees = float(self.forward)
        except ValueError:
            degrees = math.nan
        require(abs(degrees) <= 360, "forward", self.forward, "degrees from -360 to 360, or tf")  # noqa: PLR2004
        return math.radians(degrees)

    def fov_degrees(self) -> tuple[float, float] | None:
        """Return FROM and TO in degrees about forward; None: the profile's rule.

        >>> ScanParams(fov="180").fov_degrees()
        (-90.0, 90.0)
        """
        if self.fov == "profile":
            return None
        try:
            parts = [float(part) for part in self.fov.split(",")]
        except ValueError:
            parts = []
        if len(parts) == 1:
            parts = [-parts[0] / 2, parts[0] / 2]
        good = len(parts) == 2 and 0 < parts[1] - parts[0] <= 360  # noqa: PLR2004
        require(good, "fov", self.fov, "degrees like 180 or -90,90, at most 360 wide")
        return parts[0], parts[1]
