"""Tables 2 and 3, figures 7 and 8 and the sweeps, on few points."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.errors import LogError
from mpap_cli.evaluation.paper_tables import TABLE_2, TABLE_3_SYNTHETIC
from mpap_cli.simulation.texture_patches import texture_patches

Tried = Callable[..., Bench]


@pytest.fixture(scope="session")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return labelled patches of two classes, as a user may name them."""
    made = texture_patches(seed=5, n_a_class=30)
    kept = made.classes < 2
    path = tmp_path_factory.mktemp("patches") / "two.npz"
    np.savez(
        path,
        patches=made.patches[kept][..., ::-1],
        labels=made.classes[kept],
        class_names=np.array(made.class_names[:2]),
    )
    return path


def test_table_2_has_the_papers_methods_first(tried: Tried) -> None:
    """Five rows with the paper's V-measure, then variants and peers without."""
    bench = tried("textures")

    rows = [
        row for row in bench.found.rows if row.item == "Table 2" and row.quantity == "V-measure"
    ]

    assert [row.row for row in rows[:5]] == list(TABLE_2)
    assert [row.paper for row in rows[:5]] == list(TABLE_2.values())
    assert {row.row for row in rows[5:]} > {"ap, median", "k-means, square-root"}
    assert all(row.paper is None for row in rows[5:])


def test_procedural_textures_can_be_told_apart(tried: Tried) -> None:
    """The methods that are told the number of classes reach more than .8, and are no oracle's."""
    bench = tried("textures")

    scores = {
        row.row: row.ours
        for row in bench.found.rows
        if row.item == "Table 2" and row.quantity == "V-measure"
    }

    assert (scores["k-means, square-root"] or 0) > 0.8
    assert (scores["Affinity propagation"] or 0) > 0.6


def test_patches_of_the_user_are_clustered_in_several_orders(tried: Tried, archive: Path) -> None:
    """Their file is an input, and figure 7 shows them."""
    bench = tried("textures", textures=archive)

    points = [row.ours for row in bench.found.rows if row.quantity == "raw points"]

    assert points == [60, 60]
    assert [item.name for item in bench.found.inputs] == ["two.npz"]
    assert (bench.request.out / "figure-07.png").is_file()


def test_patches_that_are_not_there_are_named(tried: Tried, tmp_path: Path) -> None:
    """A file that cannot be read ends the command with its name."""
    with pytest.raises(LogError, match=r"none\.npz"):
        tried("textures", "table-2", textures=tmp_path / "none.npz")


def test_table_3_has_the_synthetic_lines(tried: Tried) -> None:
    """Four lines beside the paper's; affinity propagation clusters every point."""
    bench = tried("synthetic")

    rows = [row for row in bench.found.rows if row.item == "Table 3, synthetic data"]
    ours = {(row.row, row.quantity): row.ours for row in rows}

    assert list(dict.fromkeys(row.row for row in rows)) == list(TABLE_3_SYNTHETIC)
    assert ours["AP no noise", "clusters"] == 10
    assert ours["AP with noise", "clustered points"] == ours["AP with noise", "raw points"] == 500
    left = ours["MPAP with noise", "clustered points"]
    assert left is not None
    assert left < 100
    seconds = [row.seconds for row in rows if row.quantity == "duration (s)"]
    assert all(taken is not None for taken in seconds)


def test_figure_8_alone_needs_no_table(tried: Tried) -> None:
    """With ``--only figure-8`` nothing but the picture is delivered."""
    bench = tried("synthetic", "figure-8")

    assert not bench.found.rows
    assert not bench.found.findings
    assert (bench.request.out / "figure-08.png").stat().st_size > 10_000


@pytest.mark.slow
def test_sweeps_try_values_in_and_out_of_the_papers_range(tried: Tried) -> None:
    """min-points 2 to 20 and theta 2 to 25 %, on points, patches and scans."""
    bench = tried("sweeps")

    tables = {
        item: {row.row for row in bench.found.rows if row.item == item}
        for item in ("min-points 5 to 10", "theta 5 to 15 %")
    }
    quantities = {row.quantity for row in bench.found.rows}

    assert tables["min-points 5 to 10"] == {"2", "5", "7", "10", "20"}
    assert tables["theta 5 to 15 %"] == {"2 %", "5 %", "10 %", "15 %", "25 %"}
    assert {"V-measure, plane", "V-measure, patches", "held-out AUC, outdoor"} < quantities
    assert [one.item for one in bench.found.findings] == ["min-points", "theta"]


def test_table_1_says_what_the_experiments_run_on(tried: Tried) -> None:
    """It has no numbers; data of the user are named as such."""
    usual = tried("overview").found
    given = tried("overview", indoor=("a.bag",), novelty=("a", "b", "a")).found

    assert not usual.rows
    assert "indoor on simulated laser logs" in usual.findings[0].words
    assert "indoor on logs as given" in given.findings[0].words
    assert "novelty on logs as given" in given.findings[0].words
