"""Puts report.html together and in place."""

import csv
import json
import logging
from collections.abc import Sequence
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path

from mpap_cli import __version__
from mpap_cli.errors import MpapError
from mpap_cli.logs.scratch import ScratchFolder
from mpap_cli.outputs.report.charts import Chart, novelty_chart, score_charts, timeline_charts
from mpap_cli.outputs.report.clusters import cluster_sections
from mpap_cli.outputs.report.presses import MOST_DRAWN, press_views
from mpap_cli.outputs.report.runs import MOST_SIGNS, Runs, find_runs
from mpap_cli.outputs.report.sentences import sentences
from mpap_cli.outputs.report.tables import table_views

REPORT = "report.html"
LOGGER = logging.getLogger(__name__)
_NOT_OURS = (ValueError, LookupError, TypeError, ArithmeticError, csv.Error, MpapError)
"""What tables raise that no command wrote, though their settings.json names them."""

_HERE = files("mpap_cli.outputs.report")


def redraw(out: Path) -> None:
    """Draw OUT/report.html anew from the results of all commands in OUT.

    The results are in place before; where the page cannot be written, a warning says so.

    Parameters
    ----------
    out : Path
        Folder of all results.
    """
    path = out / REPORT
    try:
        page = report_page(out)
    except (*_NOT_OURS, OSError) as err:
        LOGGER.warning("%s: left as it was, the results cannot be drawn (%s)", path, err)
        return
    try:
        aside = ScratchFolder(f".{REPORT}-", out)
        try:
            beside = aside.path / REPORT
            beside.write_text(page, encoding="utf-8", errors="backslashreplace")
            beside.replace(path)
        finally:
            aside.remove()
    except OSError as err:
        LOGGER.warning("%s: cannot be written (%s)", path, (err.strerror or str(err)).lower())


def report_page(out: Path) -> str:
    """Return the page of everything found in a folder.

    Parameters
    ----------
    out : Path
        Folder of all results.

    Returns
    -------
    str
        One HTML document that needs nothing beside it. Results that cannot be drawn are left
        out of it, and named.
    """
    runs = find_runs(out)
    try:
        return _drawn(runs)
    except _NOT_OURS:
        for command, results in list(runs.by_command.items()):
            try:
                _drawn(Runs({command: results}))
            except _NOT_OURS as err:
                del runs.by_command[command]
                words = f"{command}: no results that mpap wrote ({str(err)[:MOST_SIGNS]})"
                runs.problems.append(f"{words}; run mpap {command} again")
        return _drawn(runs)


def _drawn(runs: Runs) -> str:
    """Return the page of some runs."""
    # learn is faster than this import; nothing else needs it
    from jinja2 import Environment, StrictUndefined  # noqa: PLC0415

    environment = Environment(
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined
    )
    sections = cluster_sections(runs)
    novelty = novelty_chart(runs)
    charts = {
        "scores": score_charts(runs),
        "evaluated": timeline_charts(runs, "evaluate"),
        "predicted": timeline_charts(runs, "predict"),
        "novelty": [] if novelty is None else [novelty],
    }
    presses = press_views(runs)
    return environment.from_string(_text("page.html.j2")).render(
        version=__version__,
        style=_text("page.css"),
        scripts=[_text("chart.js"), _text("page.js")],
        sentences=sentences(runs, sections),
        sections=sections,
        charts=charts,
        data=_chart_data([one for part in charts.values() for one in part]),
        presses=presses,
        is_press_limit=len(presses) == MOST_DRAWN,
        tables=table_views(runs),
        runs=list(runs.by_command.values()),
        warnings=runs.warnings(),
    )


def _text(name: str) -> str:
    """Return a file that lies beside this module."""
    return (_HERE / name).read_text(encoding="utf-8")


def _chart_data(charts: Sequence[Chart]) -> str:
    """Return the charts by key as JSON that cannot end the element it stands in."""
    text = json.dumps({one.key: asdict(one) for one in charts}, allow_nan=False)
    return text.replace("<", "\\u003c")
