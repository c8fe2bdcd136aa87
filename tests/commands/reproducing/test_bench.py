"""The notebook of an experiment."""

from pathlib import Path

import pytest

from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.request import ReproduceRequest
from mpap_cli.evaluation.reproduced import Finding, Picture, Spread


def bench_for(folder: Path, *wanted: str, seeds: int = 3, seed: int = 0) -> Bench:
    """Return a bench that is to deliver some items."""
    request = ReproduceRequest(out=folder, seeds=seeds, seed=seed)
    return Bench("laser", request, frozenset(wanted), folder, folder / "scratch")


def test_repeats_become_mean_and_spread(tmp_path: Path) -> None:
    """A row holds the mean, the deviation and how many there were, under the name of its part."""
    bench = bench_for(tmp_path, "table-4")

    found = bench.number("table-4", "Min-value", "indoor", [0.5, 0.7], paper=0.86, part="held out")

    (row,) = bench.found.rows
    assert found == Spread(row.ours, row.sd, 2)
    assert row.ours == pytest.approx(0.6)
    assert (row.experiment, row.item, row.row) == ("laser", "Table 4, held out", "Min-value")
    assert (row.quantity, row.paper, row.n, row.seconds) == ("indoor", 0.86, 2, None)


def test_durations_have_a_column_of_their_own(tmp_path: Path) -> None:
    """All other columns may be compared from run to run."""
    bench = bench_for(tmp_path, "table-3")

    mean = bench.duration("table-3", "AP", "duration (s)", [1.0, 3.0], paper=8.79)

    (row,) = bench.found.rows
    assert mean == 2.0
    assert (row.ours, row.sd, row.seconds, row.paper) == (None, None, 2.0, 8.79)


def test_what_is_not_wanted_is_not_written(tmp_path: Path) -> None:
    """Numbers, durations and findings of other items are dropped; the mean comes back."""
    bench = bench_for(tmp_path, "figure-8")

    found = bench.number("table-3", "AP", "clusters", 10)
    bench.duration("table-3", "AP", "duration (s)", 1.0)
    bench.finding("table-3", "Fast.")

    assert found == Spread(10.0, None, 1)
    assert not bench.found.rows
    assert not bench.found.findings
    assert bench.wants("table-3", "figure-8")
    assert not bench.wants("table-3")


def test_figures_are_named_by_two_digits(tmp_path: Path) -> None:
    """The file is listed with its caption, variants apart."""
    bench = bench_for(tmp_path, "figure-8", "figure-10")

    first = bench.picture("figure-8", "Gaussians.")
    second = bench.picture("figure-10", "Curves.", "held-out")

    assert (first, second) == (tmp_path / "figure-08.png", tmp_path / "figure-10-held-out.png")
    assert bench.found.pictures[0] == Picture("figure-8", "figure-08.png", "Gaussians.")


def test_findings_and_damage_are_kept(tmp_path: Path) -> None:
    """The worst exit code counts."""
    bench = bench_for(tmp_path, "table-2")

    bench.finding("table-2", "Level.")
    bench.left_out(3)
    bench.left_out(0)

    assert bench.found.findings == [Finding("table-2", "Level.")]
    assert bench.found.exit_code == 3


def test_settings_have_the_seed_and_short_runs_one_repeat(tmp_path: Path) -> None:
    """Words become keys of settings."""
    bench = bench_for(tmp_path, "table-4", seed=7)
    short = Bench(
        "laser", ReproduceRequest(out=tmp_path, short=True), frozenset(), tmp_path, tmp_path
    )

    settings = bench.settings("paper", min_points=9)

    assert (settings.meta_point.min_points, settings.affinity.seed) == (9, 7)
    assert list(bench.seeds) == [7, 8, 9]
    assert list(short.seeds) == [0]
