"""The stretches from which most can be learnt: greedy, within a budget, with their costs."""

from collections.abc import Mapping, Sequence

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.evaluation.coverage import Asked, Chosen, Sightings, choose_cells
from mpap_cli.observations import BoolArray, Float64Array

Cell = Mapping[int, int]
CELLS = st.lists(
    st.dictionaries(st.integers(0, 5), st.integers(1, 4), max_size=3), min_size=1, max_size=8
)


def see(cells: Sequence[Cell], logs: Sequence[int] | None = None) -> tuple[Sightings, Float64Array]:
    """Return sightings of cells that last 10 ns, and how often each place is seen."""
    sizes = [len(cell) for cell in cells]
    places = np.array([place for cell in cells for place in sorted(cell)], dtype=np.int64)
    counts = np.array([cell[p] for cell in cells for p in sorted(cell)], dtype=np.int64)
    log_index = np.array(logs if logs is not None else [0] * len(cells))
    length_ns = np.full(len(cells), 10)
    starts = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    weight = np.bincount(places, counts, 6).astype(np.float64)
    return Sightings(starts, places, counts, log_index, length_ns), weight


def choose(cells: Sequence[Cell], budget_ns: int, **words: int) -> Chosen:
    """Choose cells of one log without margins, unless others are named."""
    usual = {"before": 0, "after": 0, "context": 0, "enough": 1}
    asked = Asked(budget_ns=budget_ns, **{**usual, **words})
    return choose_cells(*see(cells), asked)


def test_what_is_seen_most_is_kept_first_and_once() -> None:
    """The second sighting of a place adds nothing, so the rarer place comes next."""
    chosen = choose([{0: 4}, {0: 4}, {1: 1}, {2: 2}], 20)

    assert chosen.kept.tolist() == [True, False, False, True]
    assert np.allclose(chosen.gains, [8 / 11, 0, 0, 2 / 11])
    assert chosen.best.tolist() == [0, -1, -1, 2]


def test_nothing_is_kept_that_adds_nothing() -> None:
    """The budget is not filled up with what is known."""
    chosen = choose([{0: 4}, {0: 4}, {0: 4}], 30)

    assert chosen.kept.sum() == 1


def test_margins_count_in_the_budget() -> None:
    """A cell with one before and one after costs three, and all of them teach."""
    chosen = choose([{}, {}, {0: 1}, {1: 1}, {}, {2: 3}], 30, before=1, after=1)

    assert chosen.kept.sum() <= 3
    assert chosen.kept.tolist() == [False, True, True, True, False, False] or chosen.kept[5]


def test_a_window_that_is_too_long_is_not_kept() -> None:
    """Without room for the margins nothing is kept."""
    chosen = choose([{0: 1}] * 5, 10, before=1, after=1)

    assert not chosen.kept.any() or chosen.kept.sum() == 1


def test_a_cell_without_what_was_before_it_teaches_nothing() -> None:
    """With a context the cell before is kept for the sake of the one behind."""
    chosen = choose([{}, {0: 9}, {}, {1: 1}], 20, before=1, context=1)

    assert chosen.kept.tolist() == [True, True, False, False]
    assert chosen.gains.tolist() == [0.0, 0.9, 0.0, 0.0]


def test_places_are_learnt_after_enough_sightings() -> None:
    """One sighting of a place that needs two is half of it."""
    chosen = choose([{0: 1}, {0: 1}], 10, enough=2)

    assert np.allclose(chosen.gains, [0.5, 0.0])


def test_windows_end_with_their_log() -> None:
    """Margins do not reach into another log."""
    sightings, weight = see([{0: 1}, {1: 5}, {2: 1}], [0, 1, 2])

    asked = Asked(before=1, after=1, budget_ns=10, context=0, enough=1)
    chosen = choose_cells(sightings, weight, asked)

    assert chosen.kept.tolist() == [False, True, False]


@given(CELLS, st.integers(0, 80), st.integers(0, 2), st.integers(0, 2))
def test_the_budget_holds_and_the_gains_are_what_is_covered(
    cells: list[dict[int, int]], budget_ns: int, before: int, after: int
) -> None:
    """Kept cells never last longer than asked; their gains sum to the weight they cover."""
    sightings, weight = see(cells)

    asked = Asked(before=before, after=after, budget_ns=budget_ns, context=0, enough=1)
    chosen = choose_cells(sightings, weight, asked)

    assert 10 * chosen.kept.sum() <= budget_ns
    covered = {
        place for cell, kept in zip(cells, chosen.kept, strict=True) if kept for place in cell
    }
    expected = sum(weight[place] for place in covered) / max(weight.sum(), 1.0)
    assert np.isclose(chosen.gains.sum(), expected)


@given(CELLS, st.integers(1, 8))
def test_greedy_is_never_far_from_the_best(cells: list[dict[int, int]], n_kept: int) -> None:
    """Cells of one cost: at least 63 % of what any choice of so many covers."""
    sightings, weight = see(cells)

    asked = Asked(before=0, after=0, budget_ns=10 * n_kept, context=0, enough=1)
    chosen = choose_cells(sightings, weight, asked)

    best = max(
        sum(weight[p] for p in {p for i, cell in enumerate(cells) if bits >> i & 1 for p in cell})
        for bits in range(1 << len(cells))
        if bits.bit_count() <= n_kept
    )
    assert chosen.gains.sum() * max(weight.sum(), 1.0) >= (1 - 1 / np.e) * best - 1e-9


def test_what_a_model_does_not_explain_is_chosen_again() -> None:
    """A place that was seen but not learnt keeps its worth; one that is explained loses it."""
    sightings, weight = see([{0: 9}, {0: 5}, {1: 1}, {2: 1}])
    asked = Asked(before=0, after=0, budget_ns=30, context=0, enough=1)

    def explain(cells: BoolArray) -> BoolArray:
        needs = np.array([cells[:2].all(), True, cells[3], True, True, True])
        return np.asarray(needs, dtype=np.bool_)

    chosen = choose_cells(sightings, weight, asked, explain)

    assert chosen.kept.tolist() == [True, True, False, True]
