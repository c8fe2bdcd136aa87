"""Plots of an evaluation."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from mpap_cli.outputs.plots import (
    Reliability,
    RocLine,
    Timeline,
    plot_calibration,
    plot_roc,
    plot_timeline,
)
from mpap_cli.outputs.timeline_plot import _most_contact, _thinned, _with_gaps

RATES = np.linspace(0, 1, 20)
LINES = [
    RocLine(label, panel, RATES, RATES**0.3, 0.77)
    for panel in ("6 bins", "12 bins")
    for label in ("_$min", "max-value")
]
RELIABILITY = Reliability(
    scans=np.array([900, 10, 0, 1]),
    mean_p=np.array([0.1, 0.4, np.nan, 0.9]),
    share_positive=np.array([0.0, 0.5, np.nan, 1.0]),
)


def timeline(log: str, n_scans: int = 100, n_contacts: int = 10) -> Timeline:
    """Make a log that ends in contact."""
    truth = np.zeros(n_scans)
    truth[n_scans - n_contacts :] = 1.0
    p = np.linspace(0, 1, n_scans, dtype=np.float64)
    predicted = (p >= 0.2).astype(np.float64)
    return Timeline(log, np.arange(n_scans, dtype=np.float64) * 0.2, truth, predicted, p)


def size(path: Path) -> tuple[int, int]:
    """Return height and width of a picture."""
    image = cv2.imread(str(path))
    assert image is not None
    return int(image.shape[0]), int(image.shape[1])


DRAWINGS: dict[str, Callable[[Path], None]] = {
    "roc": lambda path: plot_roc(path, LINES, "held-out"),
    "roc without curve": lambda path: plot_roc(path, []),
    "roc without area": lambda path: plot_roc(path, [RocLine("a", "", RATES, RATES, None)]),
    "timeline": lambda path: plot_timeline(path, [timeline("$a_b.bag")], 0.2),
    "timeline of nothing": lambda path: plot_timeline(path, [], 0.2),
    "timeline of one scan": lambda path: plot_timeline(path, [timeline("a", 1, 0)], 0.2),
    "calibration": lambda path: plot_calibration(path, RELIABILITY, "Brier 0.04"),
    "calibration of nothing": lambda path: plot_calibration(
        path, Reliability(np.zeros(2, np.int64), np.full(2, np.nan), np.full(2, np.nan))
    ),
}


@pytest.mark.parametrize("name", DRAWINGS)
def test_same_numbers_same_bytes(tmp_path: Path, name: str) -> None:
    """Every plot is drawn, twice with the same bytes."""
    DRAWINGS[name](tmp_path / "a.png")
    DRAWINGS[name](tmp_path / "b.png")

    content = (tmp_path / "a.png").read_bytes()
    assert content == (tmp_path / "b.png").read_bytes()
    assert content.startswith(b"\x89PNG")
    assert b"matplotlib" not in content.lower()


def test_look_does_not_depend_on_the_users_settings(tmp_path: Path) -> None:
    """A user's matplotlibrc does not change the bytes, and is not changed."""
    import matplotlib as mpl  # noqa: PLC0415  # slow, for this test only

    plot_roc(tmp_path / "a.png", LINES)
    with mpl.rc_context({"font.size": 30, "axes.facecolor": "black"}):
        plot_roc(tmp_path / "b.png", LINES)
        assert mpl.rcParams["font.size"] == 30

    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_panels_stand_side_by_side(tmp_path: Path) -> None:
    """Each number of bins has its panel."""
    plot_roc(tmp_path / "one.png", LINES[:2])
    plot_roc(tmp_path / "two.png", LINES)

    one, two = size(tmp_path / "one.png"), size(tmp_path / "two.png")
    assert one[0] == two[0]
    assert two[1] > 1.8 * one[1]


def test_logs_with_the_most_contact_are_drawn(tmp_path: Path) -> None:
    """Of too many logs those with the most contact are drawn, in the order given."""
    logs = [timeline(f"{n}.bag", n_contacts=n) for n in (3, 9, 1, 5)]
    empty = Timeline("empty.bag", *(np.empty(0) for _ in range(4)))

    shown = _most_contact([empty, *logs], 2)
    plot_timeline(tmp_path / "all.png", logs, 0.2, limit=4)
    plot_timeline(tmp_path / "two.png", logs, 0.2, limit=2)

    assert [one.log for one in shown] == ["9.bag", "5.bag"]
    assert size(tmp_path / "all.png")[0] > size(tmp_path / "two.png")[0]


def test_short_presses_survive_in_long_logs() -> None:
    """In a log of more scans than pixels one scan in contact is still seen."""
    long = timeline("a.bag", 100_000, 0)
    long.truth[54_321] = 1.0
    long.p_collision[::2] = np.nan

    thin = _thinned(long, 1000)

    assert thin.time_s.size == 1000
    assert thin.truth.sum() == 1.0
    assert not np.isnan(thin.p_collision).any()


def test_gap_is_not_filled() -> None:
    """A contact does not go on where no scan follows."""
    log = timeline("a.bag", 10, 10)
    log.time_s[5:] += 60

    broken = _with_gaps(log)

    assert broken.time_s.size == 11
    assert np.isnan(broken.truth[5])
    assert broken.time_s[5] == pytest.approx(1.0)


def test_plots_have_no_global_state() -> None:
    """Matplotlib is loaded by the first plot only, and pyplot never."""
    code = (
        "import sys, pathlib, tempfile\n"
        "import mpap_cli.outputs.plots as plots\n"
        "assert 'matplotlib' not in sys.modules\n"
        "plots.plot_roc(pathlib.Path(tempfile.mkdtemp()) / 'a.png', [])\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )

    done = subprocess.run([sys.executable, "-c", code], check=False)  # noqa: S603  # our own text

    assert done.returncode == 0
