"""Ids that were given out lead to what stands for them now."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.clustering.strap_rows.lineage import Lineage


@given(
    st.lists(st.integers(0, 40), unique=True, max_size=10),
    st.lists(st.tuples(st.integers(0, 60), st.integers(0, 60)), max_size=40),
)
def test_chains_of_heirs_are_followed(old: list[int], merges: list[tuple[int, int]]) -> None:
    """As in a dictionary of heirs, from ids known before as from those given out since."""
    living = np.array(sorted(old), np.int64)
    lineage = Lineage(living, next_id=50)
    given_out = np.concatenate([lineage.issue(7), lineage.issue(4)])
    known = [*living.tolist(), *given_out.tolist()]
    heir = {each: each for each in known}
    for a, b in merges:
        first, second = known[a % len(known)], known[b % len(known)]
        # merging what is merged already would make a ring
        if heir[first] == first and follow(heir, second) != first:
            lineage.replace(np.array([first]), np.array([second]))
            heir[first] = second

    found = lineage.current(np.arange(-1, 70))

    assert found.tolist() == [follow(heir, each) if each in heir else -1 for each in range(-1, 70)]


def follow(heir: dict[int, int], each: int) -> int:
    """Go on until somebody is his own heir."""
    while heir[each] != each:
        each = heir[each]
    return each


def test_ids_are_never_given_out_twice() -> None:
    """They go up from the next one."""
    lineage = Lineage(np.array([3, 8]), next_id=9)

    first, second = lineage.issue(2), lineage.issue(3000)

    assert first.tolist() == [9, 10]
    assert second.tolist() == list(range(11, 3011))
    assert lineage.next_id == 3011
    assert lineage.current(second).tolist() == second.tolist()


def test_nothing_is_known_of_nothing() -> None:
    """Empty arrays are fine, and every id is unknown at first."""
    lineage = Lineage()

    assert lineage.current(np.zeros(0, np.int64)).tolist() == []
    assert lineage.current(np.array([0, -1, 5])).tolist() == [-1, -1, -1]
    assert lineage.issue(0).tolist() == []
