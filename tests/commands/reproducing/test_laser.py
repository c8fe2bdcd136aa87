"""Table 4 and figures 9 to 11, on short logs."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.laser_curves import GRID, mean_curve
from mpap_cli.commands.reproducing.laser_tables import FEATURE_WORDS
from mpap_cli.evaluation.roc import Curve
from tests.commands.running import BAG, MCAP

Tried = Callable[..., Bench]


def cells(bench: Bench, item: str) -> dict[tuple[str, str], float | None]:
    """Return our numbers of one table by row and quantity."""
    return {(row.row, row.quantity): row.ours for row in bench.found.rows if row.item == item}


@pytest.mark.slow
def test_table_4_has_a_number_for_each_of_the_papers(tried: Tried) -> None:
    """Five features, six and twelve bins, two places: 20 areas beside 20 printed ones."""
    bench = tried("laser")

    rows = [row for row in bench.found.rows if row.item == "Table 4, in-sample"]

    assert len(rows) == 20
    assert all(row.ours is not None and 0.3 < row.ours <= 1 for row in rows)
    printed = {(row.row, row.quantity): row.paper for row in rows}
    assert printed["Global difference", "outdoor, 12 bins"] == 0.65
    assert printed["Mean-value", "indoor, 6 bins"] == 0.87


@pytest.mark.slow
def test_held_out_areas_stand_in_a_table_of_their_own(tried: Tried) -> None:
    """They have no number of the paper beside them, and are lower on the whole."""
    bench = tried("laser")

    seen, unseen = (cells(bench, f"Table 4, {part}") for part in ("in-sample", "held out"))

    known = [(seen[key], unseen[key]) for key in seen]
    gaps = [first - second for first, second in known if first is not None and second is not None]
    assert unseen.keys() == seen.keys()
    assert np.mean(gaps) > 0
    assert all(row.paper is None for row in bench.found.rows if row.item == "Table 4, held out")


@pytest.mark.slow
def test_other_methods_stand_beside(tried: Tried) -> None:
    """The robust profile, the nearest range and learnt baselines, held out on the same scans."""
    bench = tried("laser")

    methods = {row for row, _ in cells(bench, "Table 4, held out, other methods")}

    assert {"mpap, profile robust", "nearest range ahead, nothing learnt"} < methods
    assert {"logistic-regression", "random-forest"} < methods


@pytest.mark.slow
def test_what_the_paper_says_is_held_against_the_numbers(tried: Tried) -> None:
    """Best features, bins, maximum-range readings: a sentence each, made of this run."""
    bench = tried("laser")

    words = " ".join(one.words for one in bench.found.findings)

    best = cells(bench, "Table 4, in-sample")
    column = {feature: best[name, "indoor, 6 bins"] for feature, name in FEATURE_WORDS.items()}
    winner = max(column, key=lambda feature: column[feature] or 0.0)
    assert f"indoor with 6 bins ({winner} {column[winner]:.2f}" in words
    assert "six bins are better in" in words
    assert "beams have no return in contact" in words


@pytest.mark.slow
def test_figures_are_drawn(tried: Tried) -> None:
    """Figures 9, 10 (twice) and 11 are in the folder."""
    bench = tried("laser")

    names = {picture.file for picture in bench.found.pictures}

    assert names == {
        "figure-09.png",
        "figure-10.png",
        "figure-10-held-out.png",
        "figure-11.png",
    }
    assert all((bench.request.out / name).stat().st_size > 10_000 for name in names)


@pytest.mark.slow
def test_logs_of_the_user_are_one_history(tried: Tried) -> None:
    """They are scored against their bumper, without spread but with intervals, and are inputs."""
    bench = tried("laser", "table-4", indoor=(str(BAG), str(MCAP)), outdoor=(str(BAG),))

    data = cells(bench, "Table 4, data")
    notes = {row.note for row in bench.found.rows if row.item == "Table 4, data"}

    assert data["indoor", "logs"] == 2
    assert [item.name for item in bench.found.inputs] == [BAG.name, MCAP.name, BAG.name]
    assert any("presses of the bumper" in note for note in notes)
    assert cells(bench, "Table 4, held out, 95 % intervals")
    assert all(row.sd is None for row in bench.found.rows)
    assert not bench.found.pictures


def test_examples_of_a_log_without_camera_have_no_image(tried: Tried) -> None:
    """Figure 11 is drawn from the first indoor log that was named."""
    bench = tried("laser", "figure-11", indoor=(str(BAG),))

    assert (bench.request.out / "figure-11.png").stat().st_size > 10_000
    assert [picture.item for picture in bench.found.pictures] == ["figure-11"]


def test_curves_of_several_worlds_are_averaged_at_each_rate() -> None:
    """A perfect and a useless curve give the middle between them."""
    useless = Curve(np.array([np.inf, 0.0]), np.array([0.0, 1.0]), np.array([0.0, 1.0]))
    perfect = Curve(
        np.array([np.inf, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 1.0])
    )

    heights = mean_curve([useless, perfect])

    assert heights[0] == 0.0
    assert heights[1:] == pytest.approx((GRID + 1) / 2)


@pytest.mark.slow
def test_simulated_logs_are_removed_again(tried: Tried) -> None:
    """Nothing is left in the scratch folder but what figure 11 was drawn from."""
    bench = tried("laser")

    left = {path.name for path in Path(bench.scratch).iterdir()}

    assert all(name.startswith("examples") for name in left)
