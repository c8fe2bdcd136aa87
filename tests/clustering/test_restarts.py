"""When a rebuild is due, and when a place is known (section 3.3)."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.clustering.strap_rows.restarts import Restarts
from mpap_cli.errors import SettingError
from mpap_cli.observations import BoolArray
from mpap_cli.params import StrapParams


def plain_due(is_outlier: BoolArray, strap: StrapParams) -> int | None:
    """Return after how many points a rebuild is due first, by looking at all stretches."""
    n_learning = len(is_outlier)
    if strap.known_share:
        n_learning = int(strap.reservoir / strap.known_share) + 1
    counts = np.concatenate([[0], np.cumsum(is_outlier)])
    for end in range(1, len(is_outlier) + 1):
        if end <= n_learning and counts[end] > strap.reservoir:
            return end
        for start in range(n_learning, end):
            more = strap.noise_share * (end - start)
            if counts[end] - counts[start] > strap.reservoir + more:
                return end
    return None


@given(
    st.lists(st.tuples(st.integers(1, 30), st.sampled_from([0.0, 0.1, 0.5, 1.0])), max_size=6),
    st.integers(0, 2**32 - 1),
    st.sampled_from([1, 2, 5, 12]),
    # shares that float64 holds exactly: their sums are then exact too
    st.sampled_from([(0.0, 0.125), (0.125, 0.25), (0.25, 0.25), (0.5, 0.75)]),
    st.lists(st.integers(0, 180), max_size=3),
)
def test_a_rebuild_is_due_after_a_stretch_with_too_many_outliers(
    parts: list[tuple[int, float]],
    seed: int,
    reservoir: int,
    shares: tuple[float, float],
    cuts: list[int],
) -> None:
    """As the definition says, wherever blocks begin and end."""
    rng = np.random.default_rng(seed)
    is_outlier = np.concatenate(
        [rng.random(n) < share for n, share in parts] or [rng.random(0) < 1]
    )
    known, noise = shares
    strap = StrapParams(reservoir=reservoir, known_share=known, noise_share=noise)
    restarts, n = Restarts(strap), 0

    for block in np.split(is_outlier, sorted(min(cut, is_outlier.size) for cut in cuts)):
        n_waiting = min(int(is_outlier[:n].sum()), reservoir)
        n += restarts.take(block, n_waiting)
        if restarts.is_due:
            break

    expected = plain_due(is_outlier, strap)
    assert restarts.is_due == (expected is not None)
    assert n == (is_outlier.size if expected is None else expected)


def test_a_known_place_goes_on_without_end() -> None:
    """Outliers at the share that counts as noise never add up."""
    restarts = Restarts(StrapParams(reservoir=5, known_share=0.0625, noise_share=0.125))
    restarts.take(np.zeros(81, np.bool_), 0)

    taken = restarts.take(np.arange(100_000) % 8 == 0, 0)

    assert (taken, restarts.is_due) == (100_000, False)


def test_a_new_place_is_learnt_at_once() -> None:
    """Where nothing fits, after reservoir / (1 - noise-share) points."""
    restarts = Restarts(StrapParams())
    restarts.take(np.zeros(10**6, np.bool_), 0)

    taken = restarts.take(np.ones(10**4, np.bool_), 0)

    assert (taken, restarts.is_due) == (516, True)


@pytest.mark.parametrize(
    ("known", "noise", "match"),
    [
        (-0.1, 0.1, "known-share"),
        (1.0, 1.0, "known-share"),
        (0.2, 0.1, "noise-share"),
        (0.2, 1.0, "noise-share"),
    ],
)
def test_shares_are_checked(known: float, noise: float, match: str) -> None:
    """What counts as noise in a known place is at least what makes it known."""
    with pytest.raises(SettingError, match=match):
        StrapParams(known_share=known, noise_share=noise)
