"""Remembered moments come by their distance, apart from each other, none from the future."""

import numpy as np

from mpap_cli.evaluation.remembering import Moment, nearest_moments

S = 1_000_000_000


def moments_at(*places: tuple[str, float]) -> list[Moment]:
    """Return moments of logs that begin at 100 s."""
    return [Moment(log, 100 * S, 100 * S + round(at * S), -1) for log, at in places]


def test_nearest_first_and_apart() -> None:
    """Of two near moments the more similar one is shown; the patch that is nearest counts."""
    moments = moments_at(("a", 1.0), ("a", 2.0), ("a", 9.0), ("b", 1.5))
    known = np.array([[0.3], [0.1], [0.2], [0.4]], dtype=np.float32)
    (seen,) = moments_at(("c", 0.0))
    features = np.array([[0.0], [9.0]], dtype=np.float32)

    rows = nearest_moments(moments, known, seen, features, 10, 5.0)

    assert [(row.log, row.time_s) for row in rows] == [("a", 2.0), ("a", 9.0), ("b", 1.5)]
    np.testing.assert_allclose([row.distance for row in rows], [0.1, 0.2, 0.4], rtol=1e-6)


def test_own_log_counts_only_before() -> None:
    """Neither the moment itself nor what came after it is an earlier one."""
    moments = moments_at(("a", 1.0), ("a", 8.0), ("a", 10.0), ("a", 20.0))
    (seen,) = moments_at(("a", 10.0))
    known = np.zeros((4, 2), dtype=np.float32)

    rows = nearest_moments(moments, known, seen, known[:1], 10, 5.0)

    assert [row.time_s for row in rows] == [1.0]


def test_no_more_than_asked_for() -> None:
    """The count limits; a model that knows nothing has no moments."""
    moments = moments_at(("a", 0.0), ("b", 0.0), ("c", 0.0))
    known = np.array([[3.0], [2.0], [1.0]], dtype=np.float32)
    (seen,) = moments_at(("d", 0.0))

    rows = nearest_moments(moments, known, seen, np.zeros((1, 1), np.float32), 2, 5.0)

    assert [row.log for row in rows] == ["c", "b"]
    assert nearest_moments([], known[:0], seen, known[:1], 2, 5.0) == []
