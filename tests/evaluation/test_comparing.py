"""What of each log the others leave unknown."""

import numpy as np

from mpap_cli.evaluation.comparing import Comparison
from mpap_cli.systems.obstacles import KnownExemplars

EYE = np.eye(4, dtype=np.float32)


def test_each_against_each_and_all() -> None:
    """All others together know what any of them knows."""
    known = [
        KnownExemplars(EYE[:1], 0.5),
        KnownExemplars(EYE[1:2], 0.5),
        KnownExemplars(EYE[2:3], 0.5),
    ]
    comparison = Comparison(["a", "b", "c"], known)

    comparison.add(0, EYE[:2])
    comparison.add(0, EYE[2:])
    comparison.add(1, EYE[:1])
    rows = {(row.log, row.against): row.unknown for row in comparison.rows()}

    assert rows["a", "b"] == 3
    assert rows["a", "c"] == 3
    assert rows["a", "all others"] == 2
    assert rows["b", "a"] == 0
    assert rows["b", "c"] == 1
    assert rows["b", "all others"] == 0
    assert len(rows) == 9


def test_log_without_observations() -> None:
    """Its shares are 0, not a division by zero."""
    comparison = Comparison(["a", "b"], [KnownExemplars(EYE[:1], 0.5)] * 2)

    comparison.add(0, EYE)

    assert [row.percent_unknown for row in comparison.rows()] == [75.0, 75.0, 0.0, 0.0]
