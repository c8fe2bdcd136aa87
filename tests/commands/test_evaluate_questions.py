"""``mpap evaluate``: protocols, targets, truth, groups and sweeps."""

import shutil
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from tests.commands.running import (
    BAG,
    FIXTURES,
    PAPER,
    done,
    evaluated,
    mpap,
    rows_of,
)

Made = Callable[..., Path]
IN_SAMPLE = ("--protocol", "in-sample")


def truth_file(folder: Path, *names: str) -> Path:
    """Write the truth of some fixture logs into one file."""
    texts = [(FIXTURES / f"{name}.truth.csv").read_text(encoding="utf-8") for name in names]
    lines = [texts[0].splitlines()[0], *(row for text in texts for row in text.splitlines()[1:])]
    path = folder / "truth.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "protocol", ["blocked", "leave-one-log-out", "in-sample", "prequential", "leave-one-group-out"]
)
@pytest.mark.slow
def test_every_protocol_scores(learnt: Path, protocol: str) -> None:
    """Each protocol gives an area for mpap and every baseline, and says which it was."""
    groups = ("--groups", r"indoor-(a\d?)\.") if "group" in protocol else ()

    done("evaluate", "--protocol", protocol, *groups, "-o", learnt)

    rows = evaluated(learnt, "auc")
    assert {row["protocol"] for row in rows} == {protocol}
    assert all(0 <= float(row["auc"]) <= 1 for row in rows)
    scored = [
        float(row["p_collision"]) for row in evaluated(learnt, "timeline") if row["p_collision"]
    ]
    assert all(0 <= p <= 1 for p in scored)
    assert len(scored) == 1600 or protocol == "prequential"


@pytest.mark.slow
def test_folds_without_a_model_before_them_are_not_scored(learnt: Path) -> None:
    """Prequential: the first block has nothing to learn from, its scans have no score."""
    done("evaluate", "--protocol", "prequential", "-o", learnt)

    timeline = evaluated(learnt, "timeline")
    empty = [row["p_collision"] == "" for row in timeline]
    n_empty = sum(empty)
    assert 0 < n_empty < 800
    assert all(empty[:n_empty])


@pytest.mark.slow
def test_the_target_decides_the_truth(learnt: Path) -> None:
    """Onset marks fewer scans than contact; early marks scans before the press."""
    found = {}
    for target in ("contact", "onset", "early:1"):
        done("evaluate", *IN_SAMPLE, "--target", target, "-o", learnt)
        found[target] = evaluated(learnt, "timeline")

    truth = {
        name: {(row["log_index"], row["stamp_ns"]) for row in rows if row["truth"] == "1"}
        for name, rows in found.items()
    }
    assert truth["onset"] < truth["contact"]
    assert truth["early:1"]
    assert not truth["early:1"] & truth["contact"]
    assert all(row["target"] == "early:1" for row in evaluated(learnt, "auc"))


@pytest.mark.slow
def test_the_truth_of_the_simulator_can_be_scored(made: Made, tmp_path: Path) -> None:
    """--truth replaces the bumper in the score, not in what is learnt."""
    truth = truth_file(tmp_path, "indoor-a.bag")
    bumper = made("evaluate", BAG, *IN_SAMPLE)

    done("evaluate", BAG, *IN_SAMPLE, "--truth", truth, "-o", tmp_path / "out")

    rows = evaluated(tmp_path / "out", "auc")
    assert {row["truth"] for row in rows} == {"truth.csv"}
    assert {row["truth"] for row in evaluated(bumper, "auc")} == {"bumper"}
    expected = [float(row["start_s"]) for row in rows_of(truth)]
    found = [float(row["start_s"]) for row in evaluated(tmp_path / "out", "presses")]
    assert found == pytest.approx(expected)
    assert evaluated(tmp_path / "out", "clusters") == evaluated(bumper, "clusters")


@pytest.mark.slow
def test_its_own_presses_change_nothing(made: Made, tmp_path: Path) -> None:
    """presses.csv, unedited, given as --truth gives the same scores."""
    before = made("evaluate", BAG, *IN_SAMPLE)
    truth = before / "evaluate" / "presses.csv"

    done("evaluate", BAG, *IN_SAMPLE, "--truth", truth, "-o", tmp_path / "out")

    assert [row["auc"] for row in evaluated(tmp_path / "out", "auc")] == [
        row["auc"] for row in evaluated(before, "auc")
    ]


def test_truth_of_another_log_is_refused(made: Made, tmp_path: Path) -> None:
    """A log that is not scored in --truth is named, with exit code 2."""
    out = Path(shutil.copytree(made("learn", BAG), tmp_path / "out"))

    outcome = mpap("evaluate", "--truth", truth_file(tmp_path, "indoor-b"), "-o", out)

    assert outcome.code == 2
    assert "indoor-b" in outcome.err
    assert not (out / "evaluate").exists()


@pytest.mark.slow
def test_groups_come_from_folder_path_or_file(tmp_path: Path) -> None:
    """Parent folder, regular expression and file give the same groups, and the same bytes."""
    names = ("indoor-a.bag", "indoor-a2.mcap", "outdoor.mcap")
    for name, folder in zip(names, ("flat", "flat", "yard"), strict=True):
        (tmp_path / folder).mkdir(exist_ok=True)
        shutil.copy(FIXTURES / name, tmp_path / folder / name)
    logs = sorted((tmp_path / "flat").iterdir()) + sorted((tmp_path / "yard").iterdir())
    file = tmp_path / "groups.csv"
    lines = "".join(f"{log.name},{log.parent.name}\n" for log in logs)
    file.write_text(f"log,group\n{lines}", encoding="utf-8")
    found = []

    for number, groups in enumerate(("folder", "(flat|yard)/", file)):
        out = tmp_path / str(number)
        done("evaluate", *logs, "--groups", groups, *PAPER, "-o", out)
        found.append((out / "evaluate" / "auc.csv").read_bytes())

    assert found[0] == found[1] == found[2]
    first = evaluated(tmp_path / "0", "auc")[0]
    assert (first["protocol"], first["folds_scored"], first["logs"]) == (
        "leave-one-group-out",
        "2",
        "3",
    )


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--protocol", "leave-one-group-out"), "--groups"),
        (("--groups", "nothing-like-it(x)"), "matches nothing"),
        (("--groups", "indoor"), "no bracket"),
        (("--sweep", "theta"), "KEY=V1,V2"),
        (("--sweep", "thera=1,2"), "thera"),
        (("--target", "late"), "late"),
        (("--bins", "6,"), "--bins 6,"),
    ],
)
def test_what_cannot_be_scored_is_named(
    made: Made, tmp_path: Path, words: tuple[str, ...], expected: str
) -> None:
    """Wrong words end with exit code 2, one line and no results."""
    out = Path(shutil.copytree(made("learn", BAG), tmp_path / "out"))

    outcome = mpap("evaluate", *words, "-o", out)

    assert outcome.code == 2
    assert expected in outcome.err.splitlines()[-1]
    assert not (out / "evaluate").exists()


@pytest.mark.slow
def test_a_sweep_adds_a_row_for_every_value(made: Made, tmp_path: Path) -> None:
    """Each value of the setting has its row; a larger theta gives fewer meta-points."""
    out = Path(shutil.copytree(made("learn", BAG), tmp_path / "out"))

    done("evaluate", *IN_SAMPLE, "--sweep", "theta=0.05,0.08,0.2", "-o", out)

    rows = evaluated(out, "auc")
    assert [row["method"] for row in rows[:4]] == [
        "mpap",
        "mpap theta=0.05",
        "mpap theta=0.08",
        "mpap theta=0.2",
    ]
    points = [int(row["meta_points"]) for row in rows[:4]]
    assert points[0] == points[2]
    assert all(before > after for before, after in pairwise(points[1:]))
    assert rows[0]["auc"] == rows[2]["auc"]


@pytest.mark.slow
def test_all_features_are_scored_at_once(made: Made, tmp_path: Path) -> None:
    """The paper's five features, each with every number of bins, and what was learnt."""
    out = Path(shutil.copytree(made("learn", BAG), tmp_path / "out"))

    done("evaluate", *IN_SAMPLE, "--feature", "all", "--bins", "6,12", "-o", out)

    rows = [row for row in evaluated(out, "auc") if row["profile"]]
    features = ("min-value", "max-value", "mean-value", "global-diff", "seq-diff")
    asked = [(row["feature"], row["bins"]) for row in rows if row["method"] == "mpap"]
    assert sorted(asked) == sorted((name, bins) for name in features for bins in ("6", "12"))
    assert [row["method"] for row in rows][-1] == "mpap as learnt"
