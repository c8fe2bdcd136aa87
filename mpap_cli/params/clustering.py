"""Settings of affinity propagation and meta-points (section 3)."""

import math
from dataclasses import dataclass

from mpap_cli.params.checks import (
    MOST_COUNT,
    check_choices,
    require,
    require_seconds,
    setting,
)

SMALLEST_THETA = 1e-9
LARGEST_THETA = 1e9
LARGEST_PREFERENCE = 1e18
MOST_ITERATIONS, MOST_ROUNDS = 10_000, 1000
"""Tenfold and more what converges: a model file made by hand must not run for ever."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AffinityParams:
    """Affinity propagation (section 3.2)."""

    damping: float = setting(0.9, "3.2", "share of the old message that is kept")
    max_iter: int = setting(1000, "3.2", "most iterations of one run")
    convergence_iter: int = setting(
        50, "3.2", "iterations without a change of the exemplars that end a run"
    )
    preference: str = setting(
        "quantile:0.9", "3.2", "self-similarity: median, min, quantile:Q, range:F or a number"
    )
    similarity: str = setting(
        "neg-squared", "3.2", "s = -d^2 or s = -d", ("neg-squared", "neg-distance")
    )
    weights: str = setting(
        "none", "3.3", "count: an item weighs what its meta-point counts", ("none", "count")
    )
    seed: int = setting(0, "ours", "for jitter, bootstrap, baselines and simulator, nothing else")

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        check_choices(self)
        require(0.5 <= self.damping < 1, "damping", self.damping, "0.5 up to below 1")  # noqa: PLR2004
        most, rounds = MOST_ITERATIONS, self.convergence_iter
        require(1 <= self.max_iter <= most, "max-iter", self.max_iter, f"1 to {most:,}")
        require(1 <= rounds <= MOST_ROUNDS, "convergence-iter", rounds, f"1 to {MOST_ROUNDS:,}")
        require(0 <= self.seed < 2**32, "seed", self.seed, "0 to 4294967295")
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
        value = math.nan
    good = abs(value) <= LARGEST_PREFERENCE and (
        name == "" or (name in {"quantile", "range"} and 0 <= value <= 1)
    )
    require(good, "preference", rule, "median, min, quantile:0..1, range:0..1 or a number")
    return name or "number", value


@dataclass(frozen=True, slots=True, kw_only=True)
class MetaPointParams:
    """Meta-point affinity propagation (section 3.4)."""

    theta: float = setting(0.08, "3.4", "radius of a meta-point (theta_similarity, a distance)")
    min_points: int = setting(2, "3.4", "observations that make a noise-point a cluster-point")
    reference: str = setting(
        "mean", "3.4", "distances go to the mean or to the exemplar", ("mean", "exemplar")
    )
    exemplar: str = setting("first", "3.4", "raw point kept for a meta-point", ("first", "closest"))
    noise_ttl: float | None = setting(
        None, "3.4", "forget noise-points not seen for that many seconds (none: never)"
    )
    max_noise: int = setting(50_000, "ours", "most noise-points kept; the oldest go first")

    def __post_init__(self) -> None:
        """Check every value before its first use."""
        check_choices(self)
        fits = SMALLEST_THETA <= self.theta <= LARGEST_THETA
        require(fits, "theta", self.theta, "a distance above 0, from 1e-9 to 1e9")
        require(1 <= self.min_points <= MOST_COUNT, "min-points", self.min_points, "1 or more")
        if self.noise_ttl is not None:
            require_seconds("noise-ttl", self.noise_ttl)
        require(1 <= self.max_noise <= MOST_COUNT, "max-noise", self.max_noise, "1 or more")
