"""report.html holds what lies in the results folder, and nothing that a name smuggles in."""

import json
import logging
import re
from pathlib import Path

import pytest

from mpap_cli.outputs.report.page import redraw, report_page
from tests.outputs.report.folders import CLUSTERS, NOVELTY, TIMELINE, cluster_line, write

HOSTILE = "</script><script>alert(1)</script>\"'.bag"


def charts_of(page: str) -> dict[str, dict[str, object]]:
    """Return the data that the charts are drawn from."""
    found = re.search(r'<script type="application/json" id="charts">(.*?)</script>', page)
    assert found is not None
    charts: dict[str, dict[str, object]] = json.loads(found[1])
    return charts


def test_empty_folder(tmp_path: Path) -> None:
    """Without results the page says so."""
    page = report_page(tmp_path)

    assert "There are no results yet." in page
    assert charts_of(page) == {}


def test_clusters_come_by_probability(tmp_path: Path) -> None:
    """The most likely collision first, those without labels last; the summary names the worst."""
    lines = cluster_line(0, "0.1", 1) + cluster_line(1, "", 0) + cluster_line(2, "0.9", 2)
    write(tmp_path, "learn", {"clusters.csv": CLUSTERS + lines})

    page = report_page(tmp_path)

    assert re.findall(r"<h3>cluster (\d)", page) == ["2", "0", "1"]
    assert "60 laser scans of 1 input file make 3 clusters. Cluster 2 meant a collision" in page


def test_clusters_that_no_press_fell_into(tmp_path: Path) -> None:
    """A high probability without any press is no finding."""
    write(tmp_path, "learn", {"clusters.csv": CLUSTERS + cluster_line(0, "0.9", 0)})

    page = report_page(tmp_path)

    assert "Nothing is known of collisions" in page


def test_names_from_logs_are_text(tmp_path: Path) -> None:
    """A log named as an element of a page stays a name everywhere."""
    quoted = '"' + HOSTILE.replace('"', '""') + '"'
    write(
        tmp_path, "learn", {"clusters.csv": CLUSTERS + cluster_line(0, "0.9", 1, quoted)}, HOSTILE
    )
    novelty = f"{quoted},0,scan,0.0,60.0,1,10,5,50.0,,3\n"
    write(tmp_path, "novelty", {"novelty.csv": NOVELTY + novelty}, HOSTILE)
    timeline = f"{quoted},0,1.0,0.5,1,1,0\n"
    write(tmp_path, "evaluate", {"timeline.csv": TIMELINE + timeline}, HOSTILE)

    page = report_page(tmp_path)

    assert "<script>alert" not in page
    assert charts_of(page)["timeline-evaluate-0"]["title"] == HOSTILE


def test_page_needs_nothing_beside_it(tmp_path: Path) -> None:
    """No address of another file or host, and a policy that forbids to ask for one."""
    write(tmp_path, "learn", {"clusters.csv": CLUSTERS + cluster_line(0, "0.9", 1)})

    page = report_page(tmp_path)

    addresses = re.findall(r'(?:src|href)="([^"]+)"', page)
    assert all(one.startswith(("data:", "#")) for one in addresses)
    assert "default-src 'none'" in page


def test_results_of_two_runs_mixed(tmp_path: Path) -> None:
    """They are named and not shown; the rest is."""
    folder = write(tmp_path, "learn", {"clusters.csv": CLUSTERS + cluster_line(0, "0.9", 1)})
    (folder / "clusters.csv").write_text(CLUSTERS, encoding="utf-8")
    row = "day1.bag,0,scan,0.0,60.0,1,10,5,50.0,,3\n"
    write(tmp_path, "novelty", {"novelty.csv": NOVELTY + row})

    page = report_page(tmp_path)

    assert "learn/clusters.csv is not the file that learn/settings.json names" in page
    assert "Novelty: day1.bag 50 % new." in page


def test_page_that_cannot_be_written(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """The results are there all the same: a warning is enough."""
    (tmp_path / "report.html").mkdir()

    with caplog.at_level(logging.WARNING, logger="mpap_cli"):
        redraw(tmp_path)

    assert "report.html: cannot be written" in caplog.text
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


def test_novelty_of_logs_one_after_the_other(tmp_path: Path) -> None:
    """The second log begins where the first ends, with a mark and a break in the curves."""
    rows = (
        "a.bag,0,scan,0.0,60.0,1,10,5,50.0,,3\n"
        "a.bag,0,scan,60.0,90.0,1,10,1,10.0,,3\n"
        "b.bag,1,scan,2.0,62.0,1,10,9,90.0,80.0,3\n"
    )
    write(tmp_path, "novelty", {"novelty.csv": NOVELTY + rows})

    chart = charts_of(report_page(tmp_path))["novelty"]

    assert chart["marks"] == [[0.0, "a.bag"], [1.5, "b.bag"]]
    assert chart["x"] == [0.0, 2.5]
    series = chart["series"]
    assert isinstance(series, list)
    assert series[0]["points"][-3:] == [[1.5, None], [1.5, 90.0], [2.5, 90.0]]


def test_timeline_with_spans(tmp_path: Path) -> None:
    """Contact, alarm and prediction are spans; a scan without probability breaks the curve."""
    rows = "a.bag,0,0.0,0.5,1,0,0\na.bag,0,1.0,,0,1,1\na.bag,0,1.01,,0,1,0\n"
    write(tmp_path, "evaluate", {"timeline.csv": TIMELINE + rows})

    chart = charts_of(report_page(tmp_path))["timeline-evaluate-0"]

    assert chart["spans"] == [
        ["in contact", 1.0, 1.02],
        ["alarm", 1.0, 1.02],
        ["predicted", 0.0, 0.02],
    ]
    series = chart["series"]
    assert isinstance(series, list)
    assert series[0]["points"] == [[0.0, 0.5], [1.0, None]]
