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
        Those with a probability between 0.2 and 0.8 that have labels of both kinds, 20 or
        more and from at least two presses, the most labelled ones first.

    Notes
    -----
    The paper asks for them to be detected and handled at a higher level. One press is not
    enough: around it the floor in front of the obstacle has the obstacle's label.
    """
    found = [row for row in rows if _is_discrepancy(row)]
    return sorted(found, key=lambda row: (-_n_labels(row), row.cluster))


def _is_discrepancy(row: ClusterRow) -> bool:
    enough = _n_labels(row) >= LEAST_LABELS and row.presses >= LEAST_PRESSES
    both = row.collisions > 0 and row.non_collisions > 0
    return enough and both and LOWEST_P < (row.p_collision or 0.0) < HIGHEST_P


def _n_labels(row: ClusterRow) -> int:
    return row.collisions + row.non_collisions
