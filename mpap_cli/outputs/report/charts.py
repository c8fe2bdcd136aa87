"""What the charts of the page are drawn from: plain numbers that chart.js reads."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.calibration import calibration
from mpap_cli.outputs.report.envelope import Envelope
from mpap_cli.outputs.report.runs import MOST_SIGNS, Runs, number

Point = tuple[float, float | None]

_CONTACT, _ALARM, _PREDICTED = "in contact", "alarm", "predicted"
_TIMELINE_COLUMNS = ("log", "log_index", "time_s", "p_collision", "truth", "alarm", "predicted")
_BLOCK_ROWS = 65_536
MOST_BLOCKS = 1000
_LONGEST_S = 1e12


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """One curve: points (x, y), y None where it breaks; ``look`` line, step, dots or faint."""

    name: str
    points: Sequence[Point]
    look: str = "line"


@dataclass(frozen=True, slots=True, kw_only=True)
class Chart:
    """One chart: axes from ``low`` to ``high``, curves, spans of x in color, marks at x.

    ``spans`` are (name, start, end) with the name ``in contact``, ``alarm`` or
    ``predicted``; ``marks`` are (x, words).
    """

    key: str
    title: str
    x_label: str
    y_label: str
    x: tuple[float, float]
    y: tuple[float, float]
    series: Sequence[Series]
    spans: Sequence[tuple[str, float, float]] = ()
    marks: Sequence[tuple[float, str]] = ()
    is_square: bool = False


def score_charts(runs: Runs) -> list[Chart]:
    """Return the ROC curves and the reliability of what was evaluated last (Fig. 10)."""
    curves: dict[str, list[Point]] = {}
    for row in runs.rows("evaluate", "roc.csv"):
        name = " ".join(row[part] for part in ("method", "feature", "bins") if row[part])
        curves.setdefault(name, []).append((float(row["fpr"]), float(row["tpr"])))
    if not curves:
        return []
    chance = Series(name="chance", points=[(0.0, 0.0), (1.0, 1.0)], look="faint")
    series = [Series(name=name, points=points) for name, points in curves.items()]
    roc = Chart(
        key="roc",
        title="ROC",
        x_label="false positive rate",
        y_label="true positive rate",
        x=(0.0, 1.0),
        y=(0.0, 1.0),
        series=[*series, chance],
        is_square=True,
    )
    return [roc, *_reliability(runs)]


def _reliability(runs: Runs) -> list[Chart]:
    """Return how often it came to a collision where a probability was said."""
    chosen = runs.chosen("evaluate", "timeline.csv", ("p_collision", "truth"))
    cells = (float(cell) for pair in chosen if all(pair) for cell in pair)
    pairs = np.fromiter(cells, dtype=np.float64).reshape(-1, 2)
    scores = calibration(pairs[:, 0], pairs[:, 1] > 0)
    if scores is None:
        return []
    points = [
        (one.mean_p, one.share_positive)
        for one in scores.bins
        if one.mean_p is not None and one.share_positive is not None
    ]
    ideal = Series(name="ideal", points=[(0.0, 0.0), (1.0, 1.0)], look="faint")
    chart = Chart(
        key="calibration",
        title="Calibration of the first row",
        x_label="probability said",
        y_label="share in contact",
        x=(0.0, 1.0),
        y=(0.0, 1.0),
        series=[Series(name="ten bins", points=points, look="dots"), ideal],
        is_square=True,
    )
    return [chart]


def timeline_charts(runs: Runs, command: str) -> list[Chart]:
    """Return the probability of collision over time, a chart for each log (Fig. 9).

    Long logs are drawn by the highest probability of each stretch.
    """
    envelopes: dict[int, Envelope] = {}
    block: list[list[str]] = []
    n_blocks = 0
    for line in runs.chosen(command, "timeline.csv", _TIMELINE_COLUMNS):
        if block and (len(block) == _BLOCK_ROWS or block[0][1] != line[1]):
            _add(envelopes, block)
            block, n_blocks = [], n_blocks + 1
            if n_blocks == MOST_BLOCKS:
                runs.problems.append(f"{command}/timeline.csv: not all of so many logs are drawn")
                break
        block.append(line)
    if block:
        _add(envelopes, block)
    return [_timeline(command, index, one) for index, one in envelopes.items()]


def _add(envelopes: dict[int, Envelope], block: list[list[str]]) -> None:
    """Add rows of one log to its envelope."""
    name, index = block[0][0][:MOST_SIGNS], int(block[0][1])
    values = np.array([[float(cell) if cell else np.nan for cell in line[2:]] for line in block])
    if not (np.abs(values[:, 0]) < _LONGEST_S).all():
        msg = "timeline.csv: a time that is none"
        raise ValueError(msg)
    envelope = envelopes.setdefault(index, Envelope(name, n_flags=3))
    envelope.add(values[:, 0], values[:, 1], values[:, 2:] > 0)


def _timeline(command: str, index: int, envelope: Envelope) -> Chart:
    """Return the chart of one log."""
    times, p, flags = envelope.curve()
    end = times[-1] + envelope.width_s
    names = (_CONTACT, _ALARM, _PREDICTED)
    spans = [
        (name, *span)
        for raised, name in zip(flags.T, names, strict=True)
        for span in envelope.spans(raised)
    ]
    points = [
        (round(float(t), 3), None if np.isnan(value) else round(float(value), 4))
        for t, value in zip(times, p, strict=True)
    ]
    return Chart(
        key=f"timeline-{command}-{index}",
        title=envelope.name,
        x_label="seconds in the log",
        y_label="p(collision)",
        x=(0.0, float(end)),
        y=(0.0, 1.0),
        series=[Series(name="p(collision)", points=points)],
        spans=spans,
    )


def novelty_chart(runs: Runs) -> Chart | None:
    """Return how new each minute was, the logs one after the other (Fig. 16 to 18)."""
    curves: dict[str, list[Point]] = {"percent_novel": [], "percent_unknown_at_start": []}
    marks: list[tuple[float, str]] = []
    offset_s, end_s, latest = 0.0, 0.0, None
    for row in runs.rows("novelty", "novelty.csv"):
        start, stop = float(row["window_start_s"]), float(row["window_end_s"])
        begins = row["log_index"] != latest
        if begins:
            latest, offset_s = row["log_index"], end_s - start
            marks.append((end_s / 60, row["log"][:MOST_SIGNS]))
        end_s = max(end_s, offset_s + stop)
        for column, points in curves.items():
            if begins:
                points.append((marks[-1][0], None))
            share = number(row[column])
            points += [((offset_s + start) / 60, share), ((offset_s + stop) / 60, share)]
    if not marks:
        return None
    new, unknown = curves.values()
    return Chart(
        key="novelty",
        title="New observations, the model carried from log to log",
        x_label="minutes of all logs, one after the other",
        y_label="percent",
        x=(0.0, end_s / 60),
        y=(0.0, 100.0),
        series=[
            Series(name="new as it went on learning", points=new),
            Series(name="unknown to the model that the log began with", points=unknown),
        ],
        marks=marks,
    )
