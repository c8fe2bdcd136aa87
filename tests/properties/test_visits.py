"""Visits to clusters are counted from a file, whatever the clusters turn out to be."""

import gc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.observations import NS_PER_S, Int8Array, IntArray
from mpap_cli.properties import visits
from mpap_cli.properties.counts import SettledLabels
from mpap_cli.properties.visits import VisitSpool

ROWS = st.lists(
    st.tuples(
        st.sampled_from([0, 1, 5, 19, 20, 40]), st.integers(0, 4), st.sampled_from([-1, 0, 1])
    ),
    max_size=60,
)
CLUSTERS = np.array([0, 1, 0, -1, 2])


def settled(stamps_ns: IntArray, ids: IntArray, press_ns: IntArray) -> SettledLabels:
    """Return observations; their labels are given beside them."""
    return SettledLabels(stamps_ns, ids, np.zeros((ids.size, 3), dtype=np.int8), press_ns)


def cluster_of(ids: IntArray) -> IntArray:
    """Return the clusters of five meta-points, one of which has none."""
    return CLUSTERS[ids]


def reference(
    logs: list[tuple[IntArray, IntArray, Int8Array, IntArray]],
) -> dict[str, list[int]]:
    """Count one observation after the other."""
    found: dict[str, list[int]] = {"visits": [], "positive": [], "negative": [], "presses": []}
    for cluster in range(3):
        runs: list[set[int]] = []
        presses = set()
        for log, (stamps_ns, ids, labels, press_ns) in enumerate(logs):
            last = None
            mine = np.flatnonzero(CLUSTERS[ids] == cluster)
            for row in mine:
                if last is None or stamps_ns[row] - last >= 2 * NS_PER_S:
                    runs.append(set())
                last = stamps_ns[row]
                runs[-1].add(int(labels[row]))
                if labels[row] == 1:
                    presses.add((log, int(press_ns[row])))
        found["visits"].append(len(runs))
        found["positive"].append(sum(1 in run for run in runs))
        found["negative"].append(sum(0 in run and 1 not in run for run in runs))
        found["presses"].append(len(presses))
    return found


@given(st.lists(ROWS, min_size=1, max_size=3), st.integers(1, 50), st.integers(1, 9))
def test_visits_equal_those_counted_one_by_one(
    tables: list[list[tuple[int, int, int]]], block: int, chunk: int
) -> None:
    """However they were added and however many runs are read back at a time."""
    logs, spool = [], VisitSpool()
    for log, rows in enumerate(tables):
        table = np.array(rows, dtype=np.int64).reshape(-1, 3)
        stamps_ns = np.cumsum(table[:, 0]) * (NS_PER_S // 10)
        ids, labels = table[:, 1], table[:, 2].astype(np.int8)
        # A press goes on while labels are positive, whichever meta-point sees it.
        press_ns = np.cumsum(np.append(True, labels[1:] != labels[:-1])[: labels.size]) * 7
        logs.append((stamps_ns, ids, labels, press_ns))
        for start in range(0, ids.size, block):
            part = slice(start, start + block)
            spool.add(settled(stamps_ns[part], ids[part], press_ns[part]), labels[part], log)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(visits, "_RUNS_PER_CHUNK", chunk)
        counted = spool.count(cluster_of, 3)

    found = {name: getattr(counted, name).tolist() for name in ("visits", "positive")}
    found |= {name: getattr(counted, name).tolist() for name in ("negative", "presses")}
    assert found == reference(logs)


def test_visits_can_be_counted_again_and_added_to() -> None:
    """Counting reads the file and leaves it as it was."""
    spool, one = VisitSpool(), np.zeros(1, dtype=np.int64)
    spool.add(settled(one, one, one), one.astype(np.int8), 0)

    first = spool.count(cluster_of, 3).visits.tolist()
    spool.add(settled(one + 3 * NS_PER_S, one, one), one.astype(np.int8), 0)
    second = spool.count(cluster_of, 3).visits.tolist()

    assert (first, second) == ([1, 0, 0], [2, 0, 0])


def test_a_large_spool_lives_on_disk_and_goes_with_its_owner(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """No file is left open when nobody holds the spool any more."""
    monkeypatch.setattr(visits, "_IN_MEMORY_BYTES", 64)
    spool, stamps_ns = VisitSpool(), np.arange(500)
    ids = stamps_ns % 3

    spool.add(settled(stamps_ns, ids, stamps_ns), np.zeros(500, dtype=np.int8), 0)
    counted = spool.count(cluster_of, 3).visits.tolist()
    file = spool._file
    del spool
    gc.collect()

    assert counted == [1, 1, 0]
    assert file.closed
