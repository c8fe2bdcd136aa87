"""Clusters that stand for two things that look the same."""

import pytest

from mpap_cli.systems.cluster_rows import ClusterRow
from mpap_cli.systems.discrepancy import find_discrepancies


def row_of(cluster: int, collisions: int, non_collisions: int, presses: int) -> ClusterRow:
    """Return a cluster with these labels."""
    return ClusterRow(
        sensor="image",
        feature="hsv+lbp",
        bins=36,
        profile="robust",
        cluster=cluster,
        observations=1000,
        collisions=collisions,
        non_collisions=non_collisions,
        presses=presses,
        visits=9,
        p_collision=collisions / (collisions + non_collisions) if collisions else None,
        p_low=None,
        p_high=None,
        meta_points=3,
        exemplar_log="a.bag",
        exemplar_time_s=1.0,
        exemplar_stamp_ns=1,
        first_seen_s=0.0,
        last_seen_s=9.0,
    )


@pytest.mark.parametrize(
    ("collisions", "non_collisions", "presses", "found"),
    [
        (10, 10, 2, True),
        (5, 15, 2, True),
        (10, 9, 2, False),
        (10, 10, 1, False),
        (8, 2, 9, False),
        (16, 4, 9, False),
        (4, 16, 9, False),
        (0, 100, 0, False),
        (0, 0, 0, False),
    ],
)
def test_a_discrepancy_has_both_labels_often(
    collisions: int, non_collisions: int, presses: int, found: bool
) -> None:
    """Shares strictly between .2 and .8 out of 20 labels or more, of two presses or more."""
    rows = [row_of(0, collisions, non_collisions, presses)]

    assert (find_discrepancies(rows) == rows) is found


def test_the_most_labelled_ones_come_first() -> None:
    """Of equals the first cluster."""
    rows = [row_of(0, 10, 10, 2), row_of(1, 50, 50, 2), row_of(2, 10, 10, 2)]

    assert [row.cluster for row in find_discrepancies(rows)] == [1, 0, 2]
