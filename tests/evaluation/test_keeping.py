"""Windows about moments: widened, merged, and the best within a budget."""

import pytest

from mpap_cli.evaluation.keeping import Margins, Moment, best_within, by_log, merge, widen


def test_margins_end_where_a_log_does() -> None:
    """A moment is widened within the bounds of its own log."""
    moments = [Moment(0, 5, 6, 1.0), Moment(1, 195, 200, 1.0)]

    widened = widen(moments, Margins(10, 3), [(0, 100), (100, 198)])

    assert [(one.start_ns, one.end_ns) for one in widened] == [(0, 9), (185, 198)]


def test_a_moment_outside_its_log_is_left_out() -> None:
    """Presses of a file may end before the stretch that counts begins."""
    widened = widen([Moment(0, 5, 6, 1.0)], Margins(0, 1), [(50, 100)])

    assert widened == []


def test_seconds_become_nanoseconds() -> None:
    """Margins are given in seconds."""
    assert Margins.of_seconds(1.5, 0.25) == Margins(1_500_000_000, 250_000_000)


def test_only_what_overlaps_or_touches_is_merged() -> None:
    """Moments of other logs stay apart, and so do those with a gap between."""
    moments = [
        Moment(1, 0, 5, 0.1),
        Moment(0, 5, 8, 0.2),
        Moment(0, 0, 5, 0.3),
        Moment(0, 9, 10, 1),
    ]

    merged = merge(moments)

    bounds = [(one.log_index, one.start_ns, one.end_ns, one.score) for one in merged]
    assert bounds == [(0, 0, 8, 0.3), (0, 9, 10, 1), (1, 0, 5, 0.1)]


def test_the_best_moments_are_kept_first() -> None:
    """What does not fit is passed over; what overlaps counts once."""
    moments = [
        Moment(0, 0, 10, 0.5),
        Moment(0, 100, 160, 0.9),
        Moment(0, 5, 15, 0.4),
        Moment(1, 0, 5, 0.1),
    ]

    kept = best_within(moments, 20)

    assert [(one.log_index, one.start_ns, one.end_ns) for one in kept] == [(0, 0, 15), (1, 0, 5)]


@pytest.mark.parametrize("budget_ns", [0, 4])
def test_nothing_is_kept_where_nothing_fits(budget_ns: int) -> None:
    """A budget shorter than every moment keeps none."""
    assert best_within([Moment(0, 0, 5, 1.0)], budget_ns) == []


def test_moments_are_parted_by_log() -> None:
    """Each log has its moments, in order."""
    moments = [Moment(0, 0, 1, 1.0), Moment(0, 5, 6, 1.0), Moment(2, 0, 1, 1.0)]

    parted = list(by_log(moments))

    assert parted == [(0, moments[:2]), (2, moments[2:])]
