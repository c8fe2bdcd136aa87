"""``mpap evaluate``: methods compared with each other, visible presses, operating points."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.commands.running import BAG, MCAP, done, evaluated, record_of, rows_of

Made = Callable[..., Path]
IN_SAMPLE = ("--protocol", "in-sample")


def test_every_other_method_is_compared_with_the_first(made: Made) -> None:
    """In the order of auc.csv, with all presses and then with the visible ones."""
    out = made("evaluate", BAG, *IN_SAMPLE)

    auc, rows = evaluated(out, "auc"), evaluated(out, "differences")
    others = [row["method"] for row in auc[1:]]
    assert [row["against"] for row in rows] == others * 2
    assert [row["scored"] for row in rows] == [
        *["all presses"] * len(others),
        *["visible presses"] * len(others),
    ]
    assert {row["method"] for row in rows} == {"mpap"}
    for row, other in zip(rows, auc[1:], strict=False):
        assert float(row["diff"]) == pytest.approx(float(auc[0]["auc"]) - float(other["auc"]))
        assert float(row["diff_low"]) <= float(row["diff"]) <= float(row["diff_high"])
        assert (row["logs"], row["diff_per_log_low"]) == ("1", "")


def test_operating_points_agree_with_the_presses(made: Made) -> None:
    """The row at the threshold below counts what presses.csv lists."""
    out = made("evaluate", BAG, *IN_SAMPLE)

    presses = evaluated(out, "presses")
    judged = [row for row in presses if row["predicted"]]
    points = [row for row in evaluated(out, "operating") if row["method"] == "mpap"]
    at = next(row for row in points if float(row["threshold"]) < 0.2)
    above = [row for row in points if float(row["threshold"]) >= 0.2]
    assert at["presses"] == str(len(judged))
    announced = sum(row["predicted"] == "1" for row in judged)
    assert int(above[-1]["announced"]) <= announced <= int(at["announced"])
    seen = [row for row in judged if row["visible"] == "1"]
    assert at["visible_presses"] == str(len(seen))
    assert all(0 <= float(row["alarm_share"]) <= 1 for row in points)
    assert {row["method"] for row in evaluated(out, "operating")} == {
        row["method"] for row in evaluated(out, "auc")
    }


@pytest.mark.slow
def test_what_is_visible_is_a_setting(made: Made, tmp_path: Path) -> None:
    """With a limit that nothing reaches no press is visible, and nothing is left to score."""
    words = ("--set", "visible-m=0.01", "--set", "visible-margin-m=0", "--set", "visible-deg=1")
    usual = made("evaluate", BAG, *IN_SAMPLE)

    out = done("evaluate", BAG, *IN_SAMPLE, *words, "-o", tmp_path / "out").out

    first, before = evaluated(tmp_path / "out", "auc")[0], evaluated(usual, "auc")[0]
    seen = sum(row["visible"] == "1" for row in evaluated(tmp_path / "out", "presses"))
    assert int(first["visible_presses"]) == seen < int(before["visible_presses"])
    assert first["auc"] == before["auc"]
    assert first["auc_visible"] != before["auc_visible"]
    assert "something near was seen ahead" in out
    assert record_of(tmp_path / "out" / "evaluate")["settings"]["visible-m"] == "0.01"


@pytest.mark.slow
def test_presses_of_predict_tell_what_was_visible(made: Made, tmp_path: Path) -> None:
    """As evaluate does."""
    model = made("learn", BAG)

    done("predict", model, MCAP, "-o", tmp_path / "out")

    cells = [row["visible"] for row in rows_of(tmp_path / "out" / "predict" / "presses.csv")]
    assert set(cells) <= {"0", "1", ""}
    assert "1" in cells
