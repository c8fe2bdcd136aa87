"""``extract``: what is kept of logs, how much, and that it is whole or not there."""

import csv
from dataclasses import replace
from pathlib import Path

import pytest

from mpap_cli.commands.extract import Extracted, extract
from mpap_cli.commands.extracting.request import ExtractRequest
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.learn import LearnRequest, learn
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.errors import ModelError, UsageError
from mpap_cli.logs.reader import open_log
from mpap_cli.outputs.results_reader import read_results

FIXTURES = Path(__file__).parents[2] / "fixtures"
BAG, MCAP, FOLDER = (FIXTURES / name for name in ("indoor-a.bag", "indoor-a2.mcap", "indoor-b"))
ENDINGS = [(BAG, ".bag"), (MCAP, ".mcap"), (FOLDER, "")]
Rows = list[tuple[str, int, bytes]]


def run(request: ExtractRequest, *logs: Path, **words: str) -> Extracted:
    """Extract from logs with the usual settings."""
    selection = LogSelection(logs=tuple(map(str, logs)), sensor="scan", **words)  # type: ignore[arg-type]
    return extract(selection, SettingsRequest(), request)


def presses(out: Path, **words: object) -> ExtractRequest:
    """Ask for presses."""
    return replace(ExtractRequest(out=out, reason="press", jobs=1), **words)  # type: ignore[arg-type]


def messages(path: Path) -> Rows:
    """Return topic, stamp and bytes of all messages."""
    with open_log(path) as log:
        found = list(log.messages([topic.name for topic in log.topics]))
    return [(one.topic.name, one.stamp_ns, one.payload) for one in found]


def start_of(path: Path) -> int:
    """Return the stamp of the first message."""
    with open_log(path) as log:
        return log.start_ns


@pytest.mark.parametrize(("path", "ending"), ENDINGS)
def test_presses_are_cut_with_their_margins(path: Path, ending: str, tmp_path: Path) -> None:
    """Each segment holds every message of its window, in the container of the log."""
    found = run(presses(tmp_path, lookback_s=1.0, post_s=0.5), path)

    assert found.rows
    name = f"0-{path.stem}{ending}"
    assert found.logs == [name]
    start_ns = start_of(path)
    windows = [
        (start_ns + round(r.start_s * 1e9), start_ns + round(r.end_s * 1e9)) for r in found.rows
    ]
    kept = [row for row in messages(path) if any(a <= row[1] < b for a, b in windows)]
    cut = messages(tmp_path / "extract" / name)
    latched = [row for row in cut if row not in kept]
    assert [row for row in cut if row in kept] == kept
    assert {topic for topic, _, _ in latched} <= {"/tf_static", "/camera/camera_info"}
    assert {stamp_ns for _, stamp_ns, _ in latched} <= {a for a, _ in windows}
    assert sum(row.messages for row in found.rows) == len(cut)
    assert sum(row.bytes for row in found.rows) == sum(len(payload) for *_, payload in cut)


def test_segments_are_listed_and_described(tmp_path: Path) -> None:
    """segments.csv has the columns of the contract; settings.json names it and the log."""
    found = run(presses(tmp_path), BAG)

    with (tmp_path / "extract" / "segments.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    columns = ["log", "log_index", "start_s", "end_s", "reason", "score", "cluster"]
    assert list(rows[0]) == [*columns, "messages", "bytes"]
    assert len(rows) == len(found.rows)
    assert rows[0]["log"] == "indoor-a.bag"
    results = read_results(tmp_path / "extract")
    assert sorted(results.outputs) == ["0-indoor-a.bag", "segments.csv"]
    assert [item.name for item in results.inputs] == ["indoor-a.bag"]
    assert results.settings["reason"] == "press"


def test_split_writes_a_log_a_segment(tmp_path: Path) -> None:
    """Together they hold what one log would."""
    whole = run(presses(tmp_path / "whole", lookback_s=0.5, post_s=0.5), BAG)
    split = run(presses(tmp_path / "split", lookback_s=0.5, post_s=0.5, split=True), BAG)

    assert [row.start_s for row in split.rows] == [row.start_s for row in whole.rows]
    assert split.logs[0] == "0-indoor-a-001.bag"
    assert len(split.logs) == len(split.rows) > 1
    parts = [row for name in split.logs for row in messages(tmp_path / "split" / "extract" / name)]
    assert parts == messages(tmp_path / "whole" / "extract" / whole.logs[0])


def test_a_dry_run_writes_nothing(tmp_path: Path) -> None:
    """It lists the same segments with the same sizes, and makes no folder."""
    dry = run(presses(tmp_path / "dry", dry_run=True), BAG, FOLDER)
    wet = run(presses(tmp_path / "wet"), BAG, FOLDER)

    assert dry.rows == wet.rows
    assert dry.folder is None
    assert not (tmp_path / "dry").exists()


def test_only_chosen_topics_are_kept(tmp_path: Path) -> None:
    """A glob names them; one that names nothing is an error that lists what there is."""
    found = run(presses(tmp_path, topics=("/sc*",)), BAG)

    assert {row[0] for row in messages(tmp_path / "extract" / found.logs[0])} == {"/scan"}
    with pytest.raises(UsageError, match=r"--topics /nothing: matches no topic; there are .*/scan"):
        run(presses(tmp_path, topics=("/nothing",)), BAG)


def test_a_ratio_keeps_the_longest_presses_first(tmp_path: Path) -> None:
    """Margins count in the ratio."""
    every = run(presses(tmp_path, lookback_s=0.5, post_s=0.5, dry_run=True), BAG)
    some = run(presses(tmp_path, lookback_s=0.5, post_s=0.5, keep_ratio=0.05, dry_run=True), BAG)

    assert 0 < some.kept_s <= 0.05 * some.duration_s < every.kept_s


def test_the_new_part_is_kept_within_the_ratio(tmp_path: Path) -> None:
    """Scores are shares of what is new; the best segments add most of it."""
    request = ExtractRequest(out=tmp_path, reason="novel", keep_ratio=0.2, jobs=1)

    found = run(request, BAG, FOLDER)

    assert 0 < found.kept_s <= 0.2 * found.duration_s
    assert 0.5 < sum(row.score for row in found.rows) <= 1.0
    assert {row.reason for row in found.rows} == {"novel"}


def test_by_threshold_what_was_new_when_it_came_is_kept(tmp_path: Path) -> None:
    """The first second is new; a higher threshold keeps no more."""
    low = run(ExtractRequest(out=tmp_path, reason="novel", threshold=0.1, dry_run=True), BAG)
    high = run(ExtractRequest(out=tmp_path, reason="novel", threshold=0.2, dry_run=True), BAG)

    assert low.rows[0].start_s == 0.0
    assert 0 < high.kept_s <= low.kept_s < low.duration_s


def test_a_model_tells_what_it_does_not_know(tmp_path: Path) -> None:
    """A log like those that were learnt holds less that is new than to itself."""
    selection = LogSelection(logs=(str(BAG), str(MCAP)), sensor="scan")
    learn(selection, SettingsRequest(), LearnRequest(out=tmp_path, jobs=1))
    alone = ExtractRequest(out=tmp_path / "none", reason="novel", threshold=0.2, dry_run=True)
    taught = replace(alone, out=tmp_path)

    first, second = run(alone, FOLDER), run(taught, FOLDER)

    assert second.kept_s < first.kept_s


def test_a_log_that_the_model_at_hand_knows_is_held_against_its_past(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Else nothing would be new; one line says so."""
    selection = LogSelection(logs=(str(BAG),), sensor="scan")
    learn(selection, SettingsRequest(), LearnRequest(out=tmp_path, jobs=1))

    found = run(ExtractRequest(out=tmp_path, reason="novel", keep_ratio=0.2, dry_run=True), BAG)

    assert found.rows
    assert "learnt by the model in" in caplog.text


def test_predictions_are_cut_with_a_model(tmp_path: Path) -> None:
    """Predicted runs score their highest probability; presses are missed or announced."""
    selection = LogSelection(logs=(str(BAG), str(MCAP)), sensor="scan")
    learn(selection, SettingsRequest(), LearnRequest(out=tmp_path, jobs=1))
    base = ExtractRequest(
        out=tmp_path, reason="predicted", threshold=0.3, lookback_s=0, post_s=0, dry_run=True
    )

    predicted = run(base, FOLDER)
    false = run(replace(base, reason="false-alarm"), FOLDER)
    missed = run(replace(base, reason="missed"), FOLDER)
    pressed = run(replace(base, reason="press", threshold=None), FOLDER)

    assert predicted.rows
    assert all(row.score >= 0.3 for row in predicted.rows)
    assert len(false.rows) < len(predicted.rows)
    assert len(missed.rows) < len(pressed.rows)
    assert {row.reason for row in false.rows} <= {"false-alarm"}


def test_without_a_model_nothing_is_predicted(tmp_path: Path) -> None:
    """What is missing is named."""
    with pytest.raises(ModelError):
        run(ExtractRequest(out=tmp_path, reason="missed"), BAG)


def test_a_damaged_log_ends_with_3(tmp_path: Path) -> None:
    """What is readable of it is cut."""
    content = BAG.read_bytes()
    cut = tmp_path / "cut.bag"
    cut.write_bytes(content[: len(content) * 8 // 10])

    found = run(presses(tmp_path / "out"), cut)

    assert found.exit_code == 3
    assert messages(tmp_path / "out" / "extract" / found.logs[0])


def test_a_log_is_never_cut_by_the_time_in_headers(tmp_path: Path) -> None:
    """The option is refused, since records have log times."""
    with pytest.raises(UsageError, match="--time-source header"):
        run(presses(tmp_path), BAG, time_source="header")


def test_two_ways_to_say_how_much_are_one_too_many(tmp_path: Path) -> None:
    """Of new segments either a ratio or a threshold is asked for."""
    with pytest.raises(UsageError, match="--keep-ratio or --threshold"):
        ExtractRequest(out=tmp_path, reason="novel", keep_ratio=0.1, threshold=0.5)


def test_the_same_logs_give_the_same_bytes(tmp_path: Path) -> None:
    """Whatever the number of threads."""
    request = ExtractRequest(out=tmp_path / "1", reason="novel", keep_ratio=0.1, jobs=1)
    run(request, MCAP)
    run(replace(request, out=tmp_path / "2", jobs=2), MCAP)

    for path in (tmp_path / "1" / "extract").iterdir():
        assert (tmp_path / "2" / "extract" / path.name).read_bytes() == path.read_bytes()
