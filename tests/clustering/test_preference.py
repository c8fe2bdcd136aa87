"""Preferences: rules by name, and the range in which they matter."""

import numpy as np
import pytest

from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.clustering.preference import (
    coarse_preference,
    preference_range,
    resolve_preference,
)
from mpap_cli.errors import SettingError
from mpap_cli.observations import Float64Array
from mpap_cli.params import AffinityParams


def random_similarities(seed: int, n: int = 12) -> Float64Array:
    """Negative squared distances of random points."""
    points = np.random.default_rng(seed).normal(size=(n, 2))
    s: Float64Array = -((points[:, None] - points[None]) ** 2).sum(axis=-1)
    return s


def best_net_similarity(s: Float64Array, p: float, k: int) -> float:
    """Equation 2 for the best one or two exemplars, by trying them all."""
    n = len(s)
    sets = [(i,) for i in range(n)] if k == 1 else [(i, j) for j in range(n) for i in range(j)]
    return max(
        float(k * p + sum(max(s[i, e] for e in chosen) for i in range(n) if i not in chosen))
        for chosen in sets
    )


@pytest.mark.parametrize(
    ("rule", "expected"),
    [("median", -2.0), ("min", -4.0), ("quantile:1", -1.0), ("quantile:0.25", -3.5), ("-7", -7.0)],
)
def test_rules_go_by_the_entries_beside_the_diagonal(rule: str, expected: float) -> None:
    """The diagonal does not count."""
    s = np.array([[9.0, -1.0, -4.0], [-1.0, 9.0, -2.0], [-4.0, -2.0, 9.0]])

    assert resolve_preference(s, rule) == pytest.approx(expected)


@pytest.mark.parametrize(("n", "preference"), [(2, -0.5), (50, -0.5), (75, -0.75), (500, -5.0)])
def test_the_coarse_preference_grows_with_the_number_of_items(n: int, preference: float) -> None:
    """It is the median up to 50 items and n / 50 times the median from there on."""
    assert coarse_preference(np.full((n, n), -0.5)) == pytest.approx(preference)


def test_forbidden_pairs_do_not_count() -> None:
    """The median of what is left stays finite."""
    s = np.array([[0.0, -1.0, -np.inf], [-1.0, 0.0, -3.0], [-np.inf, -3.0, 0.0]])

    assert resolve_preference(s, "median") == -2.0


def test_without_pairs_the_preference_is_zero() -> None:
    """One item has no similarity to go by."""
    assert resolve_preference(np.zeros((1, 1)), "median") == 0.0
    assert preference_range(np.zeros((1, 1))) == (0.0, 0.0)


def test_unknown_rules_are_refused() -> None:
    """The message lists what there is."""
    with pytest.raises(SettingError, match="median, min, quantile"):
        resolve_preference(np.zeros((2, 2)), "mean")


@pytest.mark.parametrize("seed", range(8))
def test_exact_range_is_where_the_best_solutions_change(seed: int) -> None:
    """At its low end one and two clusters are worth the same."""
    s = random_similarities(seed)

    low, high = preference_range(s)

    assert best_net_similarity(s, low, 1) == pytest.approx(best_net_similarity(s, low, 2))
    assert high == pytest.approx(s[~np.eye(len(s), dtype=bool)].max())


@pytest.mark.parametrize("seed", range(8))
def test_bound_is_below_the_exact_low_end(seed: int) -> None:
    """The quick figure never exceeds the exact one."""
    s = random_similarities(seed, 30)

    quick, exact = preference_range(s, exact=False), preference_range(s)

    assert quick[0] <= exact[0] + 1e-12
    assert quick[1] == exact[1]


def test_clusters_go_from_one_to_all_over_the_range() -> None:
    """One just below the low end, two well above it, each item at the high end."""
    points = np.concatenate([np.random.default_rng(0).normal(c, 0.3, (10, 2)) for c in (0.0, 9.0)])
    s = -((points[:, None] - points[None]) ** 2).sum(axis=-1)
    low, high = preference_range(s)

    counts = [
        len(affinity_propagation(s, p, AffinityParams()).exemplars)
        for p in (low * 1.02, low * 0.5, high * 0.999)
    ]

    assert counts == [1, 2, 20]


def test_range_rule_goes_along_the_range() -> None:
    """F = 0 is the low end, F = 1 the high one."""
    s = random_similarities(1)
    low, high = preference_range(s)

    assert resolve_preference(s, "range:0") == pytest.approx(low)
    assert resolve_preference(s, "range:0.5") == pytest.approx((low + high) / 2)


def test_positive_similarities_have_a_range_too() -> None:
    """An exemplar is never represented by another one, however similar."""
    s = random_similarities(2) + 5.0

    low, _ = preference_range(s)

    assert best_net_similarity(s, low, 1) == pytest.approx(best_net_similarity(s, low, 2))


def test_range_needs_all_pairs() -> None:
    """With forbidden pairs one cluster may be impossible."""
    s = random_similarities(3)
    s[0, 1] = -np.inf

    with pytest.raises(ValueError, match="finite similarities of all pairs"):
        preference_range(s)
