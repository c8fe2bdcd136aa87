"""Settings: one frozen dataclass a system; each default says where it comes from.

A setting's key is its field's name with hyphens (``min_points`` is ``min-points``);
``--set KEY=VALUE``, a TOML file and the profiles all go through :func:`make_settings`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, get_args, get_type_hints

from mpap_cli.errors import SettingError

PAPER_FEATURES = ("min-value", "max-value", "mean-value", "global-diff", "seq-diff")
SCAN_FEATURE_NAMES = (*PAPER_FEATURES, "seq-diff-signed", "inverse-min")
READOUTS = ("exemplar", "cluster", "metapoint", "kernel")
TARGETS = ("contact", "onset", "early")


def _setting(default: Any, section: str, text: str, choices: tuple[str, ...] = ()) -> Any:
    """Make a dataclass field that carries its section in the paper, meaning and choices."""
    metadata = {"section": section, "text": text, "choices": choices}
    return field(default=default, metadata=metadata)


def _require(holds: bool, key: str, found: object, wanted: str) -> None:
    if not holds:
        msg = f"setting {key}: found {found}, expected {wanted}"
        raise SettingError(msg)


def _check_choices(params: Any) -> None:
    for item in fields(params):
        choices = item.metadata["choices"]
        found = getattr(params, item.name)
        if choices:
            _require(found in choices, key_of(item.name), found, "one of " + ", ".join(choices))


def key_of(name: str) -> str:
    """Return the setting's key for a field name.

    >>> key_of("min_points")
    'min-points'
    """
    return name.replace("_", "-")


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanParams:
    """How raw ranges are cleaned and where the bins lie (section 4.1)."""

    feature: str = _setting("inverse-min", "4.1", "value of one bin of a scan", SCAN_FEATURE_NAMES)
    bins: int = _setting(12, "5.2", "bins over the field of view")
    fov: str = _setting(
        "profile", "5.2", "field of view in degrees: one width about forward, FROM,TO, or profile"
    )
    keep_scale: bool = _setting(
        False, "eq. 7", "add a slack bin, so that equation 7 does not forget the scale"
    )
    max_range: float | None = _setting(None, "5.2", "cap on ranges in metres (none: range_max)")
    no_return: str = _setting(
        "max", "5.2", "beam without return: counts as range_max, or is left out", ("max", "drop")
    )
    near: str = _setting(
        "min", "5.2", "beam nearer than range_min: range_min, or no return", ("min", "far")
    )
    zero: str = _setting(
        "no-return", "5.2", "a range of 0: no return, or too near", ("no-return", "near")
    )
    lookback_s: float = _setting(
        0.0, "ours", "minimum over that many seconds before the scan (0: off)"
    )
    near_cap_m: float = _setting(1.0, "ours", "inverse-min: ranges above count as this")
    near_floor_m: float = _setting(0.2, "ours", "inverse-min: ranges below count as this")
    ring_weight: float = _setting(1.0, "ours", "inverse-min: weight of the nearest range all round")
    sector_weight: float = _setting(0.5, "ours", "inverse-min: weight of the sectors")
    approach_weight: float = _setting(
        0.3, "ours", "inverse-min: weight of the approach block (0: off)"
    )
    approach_s: float = _setting(
        0.6, "ours", "inverse-min: seconds over which the approach is taken"
    )

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        _check_choices(self)
        _require(1 <= self.bins <= 360, "bins", self.bins, "1 to 360")  # noqa: PLR2004
        cap = self.max_range
        _require(cap is None or cap > 0, "max-range", cap, "metres above 0")
        _require(self.lookback_s >= 0, "lookback-s", self.lookback_s, "0 or more")
        _require(self.approach_s > 0, "approach-s", self.approach_s, "more than 0")
        floor, top = self.near_floor_m, self.near_cap_m
        _require(0 < floor < top, "near-floor-m", floor, f"above 0, below near-cap-m {top}")
        weights = (self.ring_weight, self.sector_weight, self.approach_weight)
        _require(min(weights) >= 0, "ring-weight", weights, "weights of 0 or more")
        _require(sum(weights[:2]) > 0, "ring-weight", weights, "one weight above 0")
        self.fov_degrees()

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
        _require(good, "fov", self.fov, "degrees like 180 or -90,90, at most 360 wide")
        return parts[0], parts[1]


@dataclass(frozen=True, slots=True, kw_only=True)
class BumperParams:
    """How bumper messages become presses (sections 4.1 and 5.3)."""

    bump_merge: float = _setting(0.0, "ours", "join presses closer than that many seconds")
    bump_hold: float = _setting(
        0.25, "ours", "seconds a touch lasts where only touches are sent (pulse)"
    )
    bump_max_press: float | None = _setting(
        None, "ours", "longest press in seconds (none: until the release)"
    )
    bump_ignore: str = _setting(
        "ground|floor|terrain|plane", "ours", "simulated contacts with such names do not count"
    )

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        _require(self.bump_merge >= 0, "bump-merge", self.bump_merge, "0 or more")
        _require(self.bump_hold > 0, "bump-hold", self.bump_hold, "more than 0")
        longest = self.bump_max_press
        _require(longest is None or longest > 0, "bump-max-press", longest, "more than 0")


@dataclass(frozen=True, slots=True, kw_only=True)
class AffinityParams:
    """Affinity propagation (section 3.2)."""

    damping: float = _setting(0.9, "3.2", "share of the old message that is kept")
    max_iter: int = _setting(1000, "3.2", "most iterations of one run")
    convergence_iter: int = _setting(
        50, "3.2", "iterations without a change of the exemplars that end a run"
    )
    preference: str = _setting(
        "quantile:0.9", "3.2", "self-similarity: median, min, quantile:Q, range:F or a number"
    )
    similarity: str = _setting(
        "neg-squared", "3.2", "s = -d^2 or s = -d", ("neg-squared", "neg-distance")
    )
    weights: str = _setting(
        "none", "3.3", "count: an item weighs what its meta-point counts", ("none", "count")
    )
    seed: int = _setting(0, "ours", "for jitter, bootstrap, baselines and simulator, nothing else")

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        _check_choices(self)
        _require(0.5 <= self.damping < 1, "damping", self.damping, "0.5 up to below 1")  # noqa: PLR2004
        _require(self.max_iter >= 1, "max-iter", self.max_iter, "1 or more")
        rounds = self.convergence_iter
        _require(rounds >= 1, "convergence-iter", rounds, "1 or more")
        _require(self.seed >= 0, "seed", self.seed, "0 or more")
        parse_preference(self.preference)


def parse_preference(rule: str) -> tuple[str, float]:
    """Split a preference rule into its name and number.

    >>> parse_preference("quantile:0.9")
    ('quantile', 0.9)
    >>> parse_preference("-3.5")
    ('number', -3.5)
    """
    if rule in {"median", "min"}:
        return rule, 0.0
    name, _, number = rule.rpartition(":")
    try:
        value = float(number)
    except ValueError:
        value = float("nan")
    good = value == value and (  # noqa: PLR0124  # NaN is not equal to itself
        name == "" or (name in {"quantile", "range"} and 0 <= value <= 1)
    )
    _require(good, "preference", rule, "median, min, quantile:0..1, range:0..1 or a number")
    return name or "number", value


@dataclass(frozen=True, slots=True, kw_only=True)
class MetaPointParams:
    """Meta-point affinity propagation (section 3.4)."""

    theta: float = _setting(0.08, "3.4", "radius of a meta-point (theta_similarity, a distance)")
    min_points: int = _setting(2, "3.4", "observations that make a noise-point a cluster-point")
    reference: str = _setting(
        "mean", "3.4", "distances go to the mean or to the exemplar", ("mean", "exemplar")
    )
    exemplar: str = _setting(
        "first", "3.4", "raw point kept for a meta-point", ("first", "closest")
    )
    noise_ttl: float | None = _setting(
        None, "3.4", "forget noise-points not seen for that many seconds (none: never)"
    )
    max_noise: int = _setting(50_000, "ours", "most noise-points kept; the oldest go first")

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        _check_choices(self)
        _require(self.theta > 0, "theta", self.theta, "a distance above 0")
        _require(self.min_points >= 1, "min-points", self.min_points, "1 or more")
        ttl = self.noise_ttl
        _require(ttl is None or ttl > 0, "noise-ttl", ttl, "more than 0")
        _require(self.max_noise >= 1, "max-noise", self.max_noise, "1 or more")


@dataclass(frozen=True, slots=True, kw_only=True)
class PropertyParams:
    """How labels become probabilities (sections 2.3 and 4.1)."""

    learn_target: str = _setting(
        "onset",
        "4.1",
        "labels that are counted: all pressed scans, or onsets",
        ("contact", "onset"),
    )
    readout: str = _setting("kernel", "4.2.5", "where a probability is read", READOUTS)
    kernel_k: int = _setting(20, "4.2.5", "kernel: nearest meta-points that are asked")
    prior_counts: float = _setting(2.0, "ours", "kernel: pseudo-counts at the base rate")
    metapoint_prior: float = _setting(4.0, "ours", "metapoint: pseudo-counts at the cluster's rate")
    onset_s: float = _setting(1.0, "ours", "seconds of a press that count as its onset")
    release_s: float = _setting(1.0, "ours", "onset: seconds without label after a release")
    early_s: float = _setting(1.0, "ours", "early: a press begins within that many seconds")

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        _check_choices(self)
        _require(self.kernel_k >= 1, "kernel-k", self.kernel_k, "1 or more")
        _require(self.prior_counts > 0, "prior-counts", self.prior_counts, "more than 0")
        _require(self.metapoint_prior >= 0, "metapoint-prior", self.metapoint_prior, "0 or more")
        _require(self.onset_s > 0, "onset-s", self.onset_s, "more than 0")
        _require(self.release_s >= 0, "release-s", self.release_s, "0 or more")
        _require(self.early_s > 0, "early-s", self.early_s, "more than 0")


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationParams:
    """How predictions are scored (section 5.2)."""

    folds: int = _setting(5, "ours", "blocked: time blocks of a log, at most one per press")
    guard_s: float = _setting(5.0, "ours", "blocked: seconds left out beside a block")
    resamples: int = _setting(1000, "ours", "bootstrap resamples of an interval")

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        _require(self.folds >= 2, "folds", self.folds, "2 or more")  # noqa: PLR2004
        _require(self.guard_s >= 0, "guard-s", self.guard_s, "0 or more")
        _require(self.resamples >= 10, "resamples", self.resamples, "10 or more")  # noqa: PLR2004


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Everything that can change a result, beside the input itself."""

    profile: str = "robust"
    scan: ScanParams = field(default_factory=ScanParams)
    bumper: BumperParams = field(default_factory=BumperParams)
    affinity: AffinityParams = field(default_factory=AffinityParams)
    meta_point: MetaPointParams = field(default_factory=MetaPointParams)
    properties: PropertyParams = field(default_factory=PropertyParams)
    evaluation: EvaluationParams = field(default_factory=EvaluationParams)


GROUPS: dict[str, type] = {
    "scan": ScanParams,
    "bumper": BumperParams,
    "affinity": AffinityParams,
    "meta_point": MetaPointParams,
    "properties": PropertyParams,
    "evaluation": EvaluationParams,
}

PROFILES: dict[str, dict[str, str]] = {
    "robust": {"keep-scale": "true", "lookback-s": "1.0"},
    "paper": {
        "feature": "global-diff",
        "bins": "6",
        "theta": "0.10",
        "min-points": "5",
        "preference": "median",
        "learn-target": "contact",
        "readout": "exemplar",
    },
}


def setting_fields() -> dict[str, tuple[str, Any]]:
    """Map every key to the name of its group and its dataclass field."""
    return {
        key_of(item.name): (group, item) for group, kind in GROUPS.items() for item in fields(kind)
    }


def make_settings(profile: str = "robust", values: Mapping[str, str] | None = None) -> Settings:
    """Build settings from a profile and the values given on top of it.

    Parameters
    ----------
    profile : str
        ``robust`` or ``paper``.
    values : mapping of str to str, optional
        Texts by key, as after ``--set``; ``none`` empties a setting that may be empty.

    Returns
    -------
    Settings
        Checked settings.

    Raises
    ------
    SettingError
        If a key does not exist or a value does not fit.

    Examples
    --------
    >>> make_settings("paper", {"theta": "0.2"}).meta_point.theta
    0.2
    """
    if profile not in PROFILES:
        msg = f"--profile: found {profile}, expected one of {', '.join(PROFILES)}"
        raise SettingError(msg)
    known = setting_fields()
    groups: dict[str, dict[str, Any]] = {group: {} for group in GROUPS}
    for key, text in {**PROFILES[profile], **(values or {})}.items():
        if key not in known:
            msg = f"setting {key}: no such setting; 'mpap config' lists them all"
            raise SettingError(msg)
        group, item = known[key]
        groups[group][item.name] = _parse(key, text, get_type_hints(GROUPS[group])[item.name])
    made = {group: kind(**groups[group]) for group, kind in GROUPS.items()}
    return Settings(profile=profile, **made)


def _parse(key: str, text: str, kind: Any) -> Any:
    """Turn the text of a setting into its type."""
    optional = type(None) in get_args(kind)
    if optional and text == "none":
        return None
    target = get_args(kind)[0] if optional else kind
    if target is bool:
        _require(text in {"true", "false"}, key, text, "true or false")
        return text == "true"
    try:
        return target(text)
    except ValueError:
        msg = f"setting {key}: found {text}, expected {target.__name__}"
        raise SettingError(msg) from None


def settings_values(settings: Settings) -> dict[str, str]:
    """Return every setting as text by key, the inverse of :func:`make_settings`."""
    texts = {}
    for key, (group, item) in setting_fields().items():
        value = getattr(getattr(settings, group), item.name)
        texts[key] = _text(value)
    return texts


def _text(value: object) -> str:
    if value is None:
        return "none"
    return str(value).lower() if isinstance(value, bool) else str(value)
