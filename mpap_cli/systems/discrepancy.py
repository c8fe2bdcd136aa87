"""Clusters that were an obstacle at one time and none at another (section 4.2.4)."""

from collections.abc import Sequence

from mpap_cli.systems.cluster_rows import ClusterRow

LEAST_LABELS = 20
LEAST_PRESSES = 2
LOWEST_P, HIGHEST_P = 0.2, 0.8


def find_discrepancies(rows: Sequence[ClusterRow]) -> list[ClusterRow]:
    """Find clusters that may stand for two different things that look the same.

    Parameters
    ----------
    rows : sequence of ClusterRow
        All clusters.

    Returns
    -------
    list of ClusterRow
        Those with a share of obstacles between 0.2 and 0.8, out of 20 labels or more and
        from at least two presses, the most labelled ones first.

    Notes
    -----
    The paper asks for them to be detected and handled at a higher level. One press is not
    enough: around it the floor in front of the obstacle has the obstacle's label.
    """
    found = [row for row in rows if _is_discrepancy(row)]
    return sorted(found, key=lambda row: (-_n_labels(row), row.cluster))


def _is_discrepancy(row: ClusterRow) -> bool:
    n_labels = _n_labels(row)
    share = row.collisions / max(n_labels, 1)
    enough = n_labels >= LEAST_LABELS and row.presses >= LEAST_PRESSES
    return enough and LOWEST_P < share < HIGHEST_P


def _n_labels(row: ClusterRow) -> int:
    return row.collisions + row.non_collisions
