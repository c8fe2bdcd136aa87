"""Results made by hand, with the right SHA-256: the page is drawn without them, soon."""

import logging
from functools import partial
from pathlib import Path

import pytest

from benchmarks.measuring.guarded import Limits, guarded
from mpap_cli.outputs.report import runs as report_runs
from mpap_cli.outputs.report.clusters import MOST_CARDS
from mpap_cli.outputs.report.page import redraw, report_page
from tests.outputs.report.folders import CLUSTERS, NOVELTY, TIMELINE, cluster_line, write

ROW = "day1.bag,0,scan,0.0,60.0,1,10,5,50.0,,3\n"
LONG = '"' + "x" * 120_000 + '"'
AUC = "method,feature,bins,auc,auc_low,auc_high,protocol\n"
PRESSES = "log,start_s,end_s,lead_s\n"
HOSTILE = {
    "words for numbers": ("learn", "clusters.csv", CLUSTERS + cluster_line(0, "often", 1)),
    "no columns": ("learn", "clusters.csv", "sensor\nscan\n"),
    "a short row": ("learn", "clusters.csv", CLUSTERS + "scan,f,12\n"),
    "not a number": ("learn", "clusters.csv", CLUSTERS + cluster_line(0, "nan", 1)),
    "beyond all numbers": ("learn", "clusters.csv", CLUSTERS + cluster_line(0, "1e999", 1)),
    "a huge cell": ("learn", "clusters.csv", CLUSTERS + '"' + "x" * (1 << 20) + '"\n'),
    "no end of a quote": ("novelty", "novelty.csv", NOVELTY + '"' + ROW * 10_000),
    "bytes": ("learn", "clusters.csv", "\0\udcff" * 50),
    "nothing": ("learn", "clusters.csv", ""),
    "no time": ("evaluate", "timeline.csv", TIMELINE + "a.bag,0,nan,0.5,1,1,0\n"),
    "no end of time": ("evaluate", "timeline.csv", TIMELINE + "a.bag,0,inf,0.5,1,1,0\n"),
    "cut rows": ("evaluate", "timeline.csv", TIMELINE + "a.bag\n"),
    "nobody was there": ("novelty", "novelty.csv", NOVELTY + ROW.replace(",10,5,", ",0,0,")),
    "no interval": ("evaluate", "auc.csv", AUC + "mpap,f,1,high,,,\n"),
    "no press": ("evaluate", "presses.csv", PRESSES + "a.bag,-,-,-\n"),
}


def leave(out: Path, command: str, name: str, text: str) -> None:
    """Leave the results of a command, whatever a text holds."""
    write(out, command, {name: text.encode("utf-8", "surrogateescape").decode("latin-1")})


@pytest.mark.parametrize("kind", HOSTILE)
def test_what_no_command_wrote_ends_nothing(
    tmp_path: Path, kind: str, caplog: pytest.LogCaptureFixture
) -> None:
    """The page shows the results of the others, and names what it leaves out."""
    command, name, text = HOSTILE[kind]
    leave(tmp_path, command, name, text)
    write(tmp_path, "cluster", {"cluster.csv": "method,variant\nmpap,theta\n"})

    with caplog.at_level(logging.WARNING, logger="mpap_cli"):
        redraw(tmp_path)

    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<td>mpap</td>" in page
    assert len(page) < 1 << 20
    assert caplog.text == ""


@pytest.mark.parametrize(
    ("command", "name", "text"),
    [
        ("learn", "clusters.csv", CLUSTERS + cluster_line(0, "0.5", 1, LONG[:40]) * 300_000),
        ("learn", "clusters.csv", CLUSTERS + cluster_line(0, "0.5", 1, LONG) * 100),
        ("evaluate", "timeline.csv", TIMELINE + "a,0,1,0.5,1,1,0\nb,1,1,0.5,1,1,0\n" * 150_000),
        ("novelty", "novelty.csv", NOVELTY + ROW * 300_000),
        ("compare", "compare.csv", f"log,against,percent_unknown\n{LONG},{LONG},1\n" * 100),
    ],
)
def test_endless_tables_take_bounded_time_and_memory(
    tmp_path: Path, command: str, name: str, text: str
) -> None:
    """Of very many rows and long cells some are shown."""
    write(tmp_path, command, {name: text})

    outcome = guarded(partial(redraw, tmp_path), Limits(seconds=15, memory_mb=1024))

    assert not outcome.crash, outcome.crash
    assert not outcome.is_late
    assert outcome.cpu_s < 10
    assert (tmp_path / "report.html").stat().st_size < 40 << 20


def test_many_clusters_are_cut_and_told_of(tmp_path: Path) -> None:
    """The first ones are shown."""
    write(tmp_path, "learn", {"clusters.csv": CLUSTERS + cluster_line(0, "0.5", 1) * 5001})

    page = report_page(tmp_path)

    assert page.count("<h3>cluster ") == MOST_CARDS
    assert "learn/clusters.csv: only the first 5,000 are shown" in page


def test_a_table_beyond_the_limit_is_not_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its run is left out and named."""
    monkeypatch.setattr(report_runs, "MOST_BYTES", 100)
    write(tmp_path, "learn", {"clusters.csv": CLUSTERS + cluster_line(0, "0.9", 1)})

    page = report_page(tmp_path)

    assert "learn/clusters.csv is too large for the page (100 bytes)" in page
    assert "No command has finished in this folder." in page
