"""The command as a whole, on its quickest parts."""

import csv
import io
import json
from pathlib import Path

import pytest

from mpap_cli.commands.reproduce import ReproduceRequest, reproduce
from mpap_cli.commands.reproducing.experiments import EXPERIMENTS
from mpap_cli.evaluation.reproduced import ITEMS
from mpap_cli.outputs.results_reader import read_results
from tests.commands.running import BAG, digest_of, done, mpap, record_of, rows_of


def request(out: Path, *only: str, jobs: int = 1) -> ReproduceRequest:
    """Ask for some parts, small."""
    return ReproduceRequest(out=out, only=only, short=True, jobs=jobs)


def test_results_are_one_whole(tmp_path: Path) -> None:
    """Tidy table, report and figures lie in one folder, and settings.json names each."""
    found = reproduce(request(tmp_path, "figure-7", "table-2", "table-1"))

    outputs = read_results(found.folder).outputs
    assert set(outputs) == {"reproduced.csv", "reproduced.md", "figure-07.png"}
    rows = rows_of(found.folder / "reproduced.csv")
    assert list(rows[0]) == (
        "experiment item row quantity paper ours sd n seconds note".split()  # noqa: SIM905
    )
    assert len(rows) == len(found.rows)
    text = (found.folder / "reproduced.md").read_text(encoding="utf-8")
    assert text.index("## Table 1") < text.index("## Table 2") < text.index("## Figure 7")
    assert "](figure-07.png)" in text


@pytest.mark.slow
def test_jobs_do_not_change_results(tmp_path: Path) -> None:
    """Processes side by side give the same bytes, but for the seconds."""
    parts = ("table-2", "figure-7", "figure-8")

    one = reproduce(request(tmp_path / "1", *parts, jobs=1)).folder
    two = reproduce(request(tmp_path / "2", *parts, jobs=2)).folder

    without = [
        [{**row, "seconds": ""} for row in rows_of(folder / "reproduced.csv")]
        for folder in (one, two)
    ]
    assert without[0] == without[1]
    for name in ("figure-07.png", "figure-08.png"):
        assert digest_of(one / name) == digest_of(two / name)


def test_every_item_is_delivered_by_some_experiment() -> None:
    """What --only offers, some experiment makes."""
    assert {item for one in EXPERIMENTS for item in one.items} == set(ITEMS)


@pytest.mark.slow
def test_an_error_in_a_process_of_its_own_is_told_as_such(tmp_path: Path) -> None:
    """The kind of the error survives, and no results appear."""
    bad = tmp_path / "bad.npz"
    bad.write_bytes(b"no archive")

    outcome = mpap(
        "reproduce", "--only", "figure-7,table-1", "--textures", bad, "-o", tmp_path / "out"
    )

    assert outcome.code == 1
    assert outcome.err.count("bad.npz") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "code", "sentence"),
    [
        (("--only", "table-9"), 2, "--only table-9: no such part; choose from table-1"),
        (("--novelty", BAG, BAG), 2, "--novelty: found 2 logs, expected three"),
        (("--outdoor", "none.bag"), 1, "none.bag"),
        (("--indoor", BAG, "--seeds", 0), 2, "Invalid value for '--seeds'"),
    ],
)
def test_what_cannot_be_done_is_refused_at_once(
    tmp_path: Path, words: tuple[object, ...], code: int, sentence: str
) -> None:
    """One line says what was found, and nothing is written."""
    outcome = mpap("reproduce", *words, "-o", tmp_path / "out")

    assert outcome.code == code
    assert sentence in outcome.err
    assert not (tmp_path / "out").exists()


def test_several_logs_may_follow_an_option(tmp_path: Path) -> None:
    """``--novelty A B A2`` and the same option three times mean the same."""
    out = tmp_path / "out"

    done("reproduce", "--only", "table-1", "--novelty", BAG, BAG, BAG, "--seeds", 1, "-o", out)

    assert record_of(out / "reproduce")["settings"]["novelty"] == 3
    assert "novelty on logs as given" in (out / "reproduce" / "reproduced.md").read_text()


def test_tables_are_printed_in_three_shapes(tmp_path: Path) -> None:
    """For people, and the tidy table as CSV and JSON; the terminal names the folder."""
    words = ("reproduce", "--only", "table-1", "-o", tmp_path)

    table = done(*words)
    as_csv = done(*words, "--format", "csv")
    as_json = done(*words, "--format", "json")

    assert table.out.startswith("Table 1: Here: section 5.1.1")
    assert table.out.endswith(f"results: {tmp_path / 'reproduce'}\n")
    assert list(csv.DictReader(io.StringIO(as_csv.out))) == []
    assert as_csv.out.startswith("experiment,item,row")
    assert json.loads(as_json.out) == []
