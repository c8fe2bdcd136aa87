"""``learn --merge``: a leaf of each log, merged, and taken up again where it stopped."""

from pathlib import Path
from unittest.mock import patch

import pytest

from mpap_cli.commands.fleet import dask_workers
from mpap_cli.errors import LogError
from mpap_cli.logs.writing.writer import LogWriter
from tests.commands.fleet.logs import LOGS, copied, manifest, merged_bytes, states
from tests.commands.running import BAG, LEARN_FILES, MCAP, done, evaluated, mpap, record_of

ONE = ("--jobs", "1")
PART = ("--end", "30")


@pytest.fixture(scope="module")
def merged(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the results of four logs; only read them."""
    out = tmp_path_factory.mktemp("merged")
    done("learn", "--merge", *LOGS, *ONE, "-o", out)
    return out


def test_results_are_those_of_learn(merged: Path) -> None:
    """The same files appear, and settings.json names the logs in an order of their own."""
    record = record_of(merged / "learn")

    assert {path.name for path in (merged / "learn").iterdir()} >= LEARN_FILES
    assert [one["name"] for one in record["inputs"]] == sorted(path.name for path in LOGS)
    assert record["settings"]["reference"] == "exemplar"
    assert record["settings"]["merge"] is True


def test_what_is_odd_about_a_log_is_said_once(tmp_path: Path) -> None:
    """While it is learnt in this process, or in the end where an earlier run has learnt it."""
    words = ("learn", "--merge", BAG, *ONE, "--end", "20", "-o", tmp_path)

    outcomes = [done(*words), done(*words)]

    assert [one.err.count(f"{BAG.name}: no positive") for one in outcomes] == [1, 1]


def test_the_manifest_has_a_row_for_every_log(merged: Path) -> None:
    """It counts scans and presses, and names the leaf."""
    rows = manifest(merged)

    assert list(rows) == [path.name for path in LOGS]
    assert {row["state"] for row in rows.values()} == {"done"}
    assert [rows[BAG.name][name] for name in ("scans", "presses", "reason")] == ["800", "5", ""]
    assert all((merged / "leaves" / row["leaf"]).is_file() for row in rows.values())
    assert all(float(row["seconds"]) > 0 for row in rows.values())


def test_a_leaf_is_what_learn_makes_of_the_log_alone(merged: Path, tmp_path: Path) -> None:
    """So logs can be learnt anywhere and merged later."""
    leaf = merged / "leaves" / manifest(merged)[BAG.name]["leaf"]

    words = ("--set", "reference=exemplar", "--sensor", "scan")
    done("learn", BAG, *words, "-o", tmp_path)

    assert leaf.read_bytes() == (tmp_path / "learn" / "model.npz").read_bytes()


def test_merging_the_leaves_by_hand_gives_the_same(merged: Path, tmp_path: Path) -> None:
    """``mpap merge`` of the leaves writes the same model and table."""
    leaves = sorted((merged / "leaves").glob("*/model.npz"))

    done("merge", *leaves, "-o", tmp_path)

    for name in ("clusters.csv", "model.npz"):
        assert (tmp_path / "merge" / name).read_bytes() == (merged / "learn" / name).read_bytes()


@pytest.mark.slow
def test_neither_order_nor_workers_matter(merged: Path, tmp_path: Path) -> None:
    """Logs backwards, in two processes, give the same bytes."""
    done("learn", "--merge", *reversed(LOGS), "--jobs", "2", "-o", tmp_path)

    assert merged_bytes(tmp_path) == merged_bytes(merged)
    settings = "learn/settings.json"
    assert (tmp_path / settings).read_bytes() == (merged / settings).read_bytes()


@pytest.mark.slow
def test_evaluate_scores_what_was_merged(merged: Path) -> None:
    """The recording holds all logs, in the order of the model."""
    done("evaluate", "-o", merged)

    row = evaluated(merged, "auc")[0]
    assert (row["logs"], row["presses"]) == ("4", "22")


def test_what_was_learnt_is_not_read_again(tmp_path: Path) -> None:
    """With a log more, only that one is opened; again, none is."""
    name = "mpap_cli.commands.fleet.leaves.open_readable"
    done("learn", "--merge", BAG, *ONE, *PART, "-o", tmp_path)

    with (
        patch(name, side_effect=LogError("read again")),
        patch("mpap_cli.commands.fleet.leaves.describe_log", side_effect=LogError("hashed again")),
    ):
        again = mpap("learn", "--merge", BAG, *ONE, *PART, "-o", tmp_path)
        more = mpap("learn", "--merge", BAG, MCAP, *ONE, *PART, "-o", tmp_path)
    last = mpap("learn", "--merge", BAG, MCAP, *ONE, *PART, "-o", tmp_path)

    assert (again.code, more.code, last.code) == (0, 3, 0)
    assert states(tmp_path) == {BAG.name: "done", MCAP.name: "done"}
    assert f"{MCAP.name}: learnt in" in last.err
    assert f"{BAG.name}: learnt in" not in last.err


def test_other_settings_make_other_leaves(tmp_path: Path) -> None:
    """A leaf counts for its own settings only."""
    done("learn", "--merge", BAG, *ONE, *PART, "-o", tmp_path)

    other = done("learn", "--merge", BAG, *ONE, *PART, "--set", "theta=0.2", "-o", tmp_path)

    assert f"{BAG.name}: learnt in" in other.err


def test_a_garbled_leaf_is_learnt_again(tmp_path: Path) -> None:
    """What is not what was written counts as missing."""
    done("learn", "--merge", BAG, *ONE, *PART, "-o", tmp_path)
    whole = merged_bytes(tmp_path)
    leaf = tmp_path / "leaves" / manifest(tmp_path)[BAG.name]["leaf"]
    leaf.write_bytes(leaf.read_bytes()[:-9])

    again = done("learn", "--merge", BAG, *ONE, *PART, "-o", tmp_path)

    assert f"{BAG.name}: learnt in" in again.err
    assert merged_bytes(tmp_path) == whole


def test_a_log_that_fails_stops_no_other(tmp_path: Path) -> None:
    """It is named, the exit code is 3, and mended it is the only one that is learnt."""
    bad = tmp_path / "bad.bag"
    bad.write_bytes(b"no log")
    words = ("learn", "--merge", bad, BAG, *ONE, *PART, "-o", tmp_path / "out")

    failed, strict = mpap(*words), mpap(*words, "--strict")
    state = manifest(tmp_path / "out")["bad.bag"]
    bad.write_bytes(BAG.read_bytes())
    mended = mpap(*words)

    assert (failed.code, strict.code, mended.code) == (3, 1, 0)
    assert "left out: 1 log of 2 (bad.bag)" in failed.err
    assert state["state"] == "failed"
    assert "neither a ROS bag" in state["reason"]
    assert f"{BAG.name}: learnt in" not in mended.err
    assert "bad.bag: learnt in" in mended.err


def test_without_a_log_left_it_fails(tmp_path: Path) -> None:
    """Unreadable logs end with 1, and no results appear."""
    bad = tmp_path / "bad.bag"
    bad.write_bytes(b"no log")

    outcome = mpap("learn", "--merge", bad, *ONE, "-o", tmp_path / "out")

    assert outcome.code == 1
    assert "none of the 1 logs could be learnt: bad.bag" in outcome.err
    assert not (tmp_path / "out" / "learn").exists()


def test_a_log_with_images_only_is_named(tmp_path: Path) -> None:
    """One line says that scans are wanted."""
    log = tmp_path / "camera.bag"
    with LogWriter(log, "bag") as writer:
        message = {"header": {"frame_id": "c"}, "format": "jpeg", "data": [1]}
        for stamp_ns in range(10**18, 10**18 + 10**10, 10**9):
            writer.write("/camera", "sensor_msgs/msg/CompressedImage", stamp_ns, message)

    outcome = mpap("learn", "--merge", log, BAG, *ONE, *PART, "-o", tmp_path / "out")

    assert outcome.code == 3
    assert "camera.bag: has images but no scan topic" in outcome.err


def test_the_same_log_counts_once(tmp_path: Path) -> None:
    """A copy in another folder adds nothing."""
    other = copied(BAG, tmp_path / "copy", BAG.name)

    both = done("learn", "--merge", BAG, other, *ONE, *PART, "-o", tmp_path / "both")
    done("learn", "--merge", BAG, *ONE, *PART, "-o", tmp_path / "one")

    assert "the same log as" in both.err
    table = "learn/clusters.csv"
    assert (tmp_path / "both" / table).read_bytes() == (tmp_path / "one" / table).read_bytes()


def test_presses_by_hand_reach_their_logs(tmp_path: Path) -> None:
    """Each leaf takes the rows of its own log."""
    file = tmp_path / "hits.csv"
    file.write_text(f"log,start_s,end_s\n{BAG.name},3,4\n{MCAP.name},5,6\n{MCAP.name},9,9.5\n")

    words = ("--bump-from", file, *ONE, *PART, "-o", tmp_path)
    done("learn", "--merge", BAG, MCAP, *words)

    assert {name: row["presses"] for name, row in manifest(tmp_path).items()} == {
        BAG.name: "1",
        MCAP.name: "2",
    }


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--merge", "--sensor", "image"), "--merge learns from laser scans only"),
        (("--scheduler", "tcp://127.0.0.1:1"), "add --merge"),
        (("--merge", "--model", "m.npz"), "leave out --model"),
        (("--merge", "--scan-topic", "/none", *ONE), "/none"),
    ],
)
def test_words_that_do_not_fit_are_refused(
    tmp_path: Path, words: tuple[str, ...], message: str
) -> None:
    """The exit code is 2."""
    outcome = mpap("learn", BAG, *words, "-o", tmp_path)

    assert outcome.code == 2
    assert message in outcome.err


def test_a_scheduler_that_does_not_answer_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before anything is read; the exit code is 1."""
    monkeypatch.setattr(dask_workers, "_CONNECT_S", 0.3)

    words = ("--scheduler", "tcp://127.0.0.1:1", "-o", tmp_path)
    outcome = mpap("learn", "--merge", BAG, *words)

    assert outcome.code == 1
    assert "--scheduler tcp://127.0.0.1:1: no Dask scheduler answers" in outcome.err
