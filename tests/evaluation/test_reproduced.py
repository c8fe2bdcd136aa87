"""Records of a reproduction, and the numbers the paper prints."""

from mpap_cli.evaluation.paper_tables import (
    ODDITIES,
    TABLE_2,
    TABLE_3_LARGE,
    TABLE_3_OUTDOOR,
    TABLE_3_SYNTHETIC,
    TABLE_4,
)
from mpap_cli.evaluation.reproduced import ITEMS, Spread, spread


def test_a_spread_leaves_out_what_is_missing() -> None:
    """Repeats without a number count neither for the mean nor for n."""
    assert spread([None, 2.0, 4.0]) == Spread(3.0, 2**0.5, 2)
    assert spread([None, 2.0]) == Spread(2.0, None, 1)
    assert spread([None]) == Spread(None, None, 0)


def test_all_tables_and_figures_from_6_on_are_there() -> None:
    """Tables 1 to 4 and figures 6 to 18 have a key, in this order."""
    tables = [key for key in ITEMS if key.startswith("table")]
    figures = [key for key in ITEMS if key.startswith("figure")]

    assert tables == [f"table-{number}" for number in range(1, 5)]
    assert figures == [f"figure-{number}" for number in range(6, 19)]


def test_numbers_are_those_of_the_paper() -> None:
    """Spot checks, one line of each table."""
    assert TABLE_2["Meta-point affinity propagation"] == 0.88
    assert TABLE_2["STRAP"] == 0.79
    assert TABLE_3_SYNTHETIC["AP with noise"] == (35, 2500, 2500, 63.43)
    assert TABLE_3_SYNTHETIC["MPAP no noise"] == (10, 2500, 121, 0.08)
    assert TABLE_3_OUTDOOR["MPAP"] == (6, 1200, 79, 1.84)
    assert TABLE_3_LARGE["Indoor"] == (10, 48_600, 626, 307.0)
    assert TABLE_4["mean-value", 12] == (0.85, 0.81)
    assert TABLE_4["global-diff", 12] == (0.88, 0.65)
    assert len(TABLE_4) == 10


def test_oddities_belong_to_items() -> None:
    """Each contradiction is printed with something that is reproduced."""
    assert {one.item for one in ODDITIES} <= set(ITEMS)


def test_what_the_oddities_say_of_table_4_is_so() -> None:
    """Six bins are not better for min-value indoors, and .65 is the lowest area."""
    assert TABLE_4["min-value", 6][0] < TABLE_4["min-value", 12][0]
    assert min(min(pair) for pair in TABLE_4.values()) == TABLE_4["global-diff", 12][1]
