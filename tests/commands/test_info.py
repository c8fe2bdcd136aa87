"""``mpap info``: what a log or a model holds, for people and for programs."""

import csv
import io
import json
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from mpap_cli.commands.info import info
from mpap_cli.commands.inputs.progress import Report
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.logs.reader import open_log
from tests.commands.running import BAG, FIXTURES, MCAP, PAPER, done, mpap

Made = Callable[..., Path]
KEYS = (
    "path container start_stamp_ns duration_s messages topics bump scan image damage warnings "
    "can_learn"
)
FACTS = [
    ("indoor-a.bag", "bag", "/events/bumper", "edge", 5, 800, 0),
    ("indoor-a2.mcap", "mcap", "/hazard_detection", "level", 6, 800, 0),
    ("indoor-b", "rosbag2/sqlite3", "/bump", "level", 6, 800, 180),
    ("indoor-json.mcap", "mcap", "/bump", "level", 5, 1100, 0),
    ("outdoor.mcap", "mcap", "/bumper", "level", 6, 1000, 0),
    ("outdoor-gz", "rosbag2/mcap", "/bumper_contact", "pulse", 5, 1100, 0),
    ("outdoor-ros1.mcap", "mcap", "/bump", "level", 5, 1050, 180),
    ("outdoor-int8.bag", "bag", "/bump", "level", 4, 840, 0),
]


def facts_of(*words: object) -> list[dict[str, Any]]:
    """Return what ``info --format json`` prints."""
    facts: list[dict[str, Any]] = json.loads(done("info", *words, "--format", "json").out)
    return facts


@pytest.mark.parametrize(
    ("name", "container", "topic", "kind", "presses", "scans", "forward_deg"), FACTS
)
def test_every_fixture_log_is_known(  # noqa: PLR0913  # one column of the table each
    *,
    name: str,
    container: str,
    topic: str,
    kind: str,
    presses: int,
    scans: int,
    forward_deg: float,
) -> None:
    """Container, bumper with its semantics, presses, scans and forward direction are found."""
    facts = facts_of(FIXTURES / name)[0]

    assert facts["container"] == container
    bump, scan = facts["bump"], facts["scan"]
    assert (bump["topic"], bump["semantics"], bump["presses"]) == (topic, kind, presses)
    assert (scan["topic"], scan["scans"], scan["beams"]) == ("/scan", scans, 180)
    assert abs(scan["forward_deg"]) == pytest.approx(forward_deg)
    assert facts["damage"] == []
    assert f"{presses} presses" in facts["can_learn"]


def test_facts_have_the_keys_of_the_contract() -> None:
    """A list, one object a log, keys in their order."""
    facts = facts_of(BAG, MCAP)

    assert [" ".join(one) for one in facts] == [KEYS, KEYS]
    assert [Path(one["path"]).name for one in facts] == [BAG.name, MCAP.name]
    assert list(facts[0]["topics"][0]) == ["name", "type", "messages", "hz", "role", "bytes"]
    assert list(facts[0]["bump"]) == [
        "topic",
        "type",
        "semantics",
        "presses",
        "scans_pressed",
        "pressed_s",
    ]
    assert list(facts[0]["scan"]) == ["topic", "scans", "beams", "no_return_share", "forward_deg"]


def test_messages_are_those_of_the_topics() -> None:
    """The messages of a log are those of its topics, each with its role."""
    facts = facts_of(BAG)[0]

    assert sum(topic["messages"] for topic in facts["topics"]) == facts["messages"]
    roles = {topic["role"]: topic["name"] for topic in facts["topics"] if topic["role"]}
    assert roles == {"scan": "/scan", "bump": "/events/bumper"}
    assert facts["duration_s"] == pytest.approx(80, abs=0.1)


def test_csv_lists_the_topics() -> None:
    """--format csv has one row a topic."""
    rows = list(csv.DictReader(io.StringIO(done("info", BAG, MCAP, "--format", "csv").out)))

    facts = facts_of(BAG, MCAP)
    assert list(rows[0]) == ["name", "topic", "type", "messages", "hz", "role", "bytes"]
    assert [(row["name"], row["topic"], int(row["messages"])) for row in rows] == [
        (Path(one["path"]).name, topic["name"], topic["messages"])
        for one in facts
        for topic in one["topics"]
    ]


def test_a_page_says_what_would_be_used() -> None:
    """Scan, bumper, presses and what could be learnt stand in the text."""
    text = done("info", BAG).out

    assert text.startswith("indoor-a.bag: ROS 1 bag, 80.0 s from 2020-01-01 00:00:00 UTC")
    assert "scan: /scan (the only LaserScan topic): 800 scans of 180 beams" in text
    assert "bump: /events/bumper" in text
    assert "edge, 5 presses" in text
    assert "laser model: yes, 5 presses; held-out AUC: possible" in text


@pytest.mark.parametrize("log", [BAG, MCAP, FIXTURES / "indoor-b"])
def test_bytes_are_those_of_the_messages(log: Path) -> None:
    """Per topic; what describes topics between the messages may add a little."""
    with open_log(log) as reader:
        names = [topic.name for topic in reader.topics]
        n_bytes = {name: sum(len(m.payload) for m in reader.messages({name})) for name in names}

    topics = facts_of(log)[0]["topics"]

    for topic in topics:
        assert 0 <= topic["bytes"] - n_bytes[topic["name"]] < 20_000
    assert sum(topic["bytes"] for topic in topics) < sum(n_bytes.values()) + 20_000
    assert done("info", log).out.splitlines()[1].split()[-2:] == ["role", "size"]


def test_messages_of_a_broken_chunk_are_not_there(tmp_path: Path) -> None:
    """The topics count what can be read, and the damage says how much is lost."""
    content = bytearray(MCAP.read_bytes())
    content[len(content) // 2] ^= 0xFF
    log = tmp_path / MCAP.name
    log.write_bytes(content)

    outcome = mpap("info", log, "--format", "json")

    (facts,) = json.loads(outcome.out)
    (whole,) = facts_of(MCAP)
    n_messages = sum(topic["messages"] for topic in facts["topics"])
    n_lost = whole["messages"] - facts["messages"]
    assert outcome.code == 3
    assert 0 < n_lost == whole["messages"] - n_messages
    assert f"chunks damaged and left out, {n_lost:,} messages lost" in facts["damage"][0]
    scans = next(topic for topic in facts["topics"] if topic["name"] == "/scan")
    assert scans["messages"] == facts["scan"]["scans"]


def test_topics_can_be_chosen() -> None:
    """--bump-from none leaves the bumper out, --start cuts the scans."""
    without = facts_of(BAG, "--bump-from", "none")[0]
    later = facts_of(BAG, "--start", "30")[0]

    assert without["bump"] is None
    assert "clusters only" in without["can_learn"]
    assert later["scan"]["scans"] == 500
    assert later["bump"]["presses"] == 4


@pytest.mark.parametrize("words", [(), PAPER])
def test_a_model_says_what_it_knows(made: Made, words: tuple[str, ...]) -> None:
    """A results folder and its model file tell profile, clusters, and the logs learnt."""
    out = made("learn", BAG, MCAP, *words)

    of_folder, of_file = facts_of(out, out / "learn" / "model.npz")

    assert of_folder["logs"] == [
        {"name": "indoor-a.bag", "scans": 800, "images": None, "presses": 5},
        {"name": "indoor-a2.mcap", "scans": 800, "images": None, "presses": 6},
    ]
    assert (of_folder["image_clusters"], of_folder["exemplars"]) == (None, None)
    assert of_folder["profile"] == ("paper" if words else "robust")
    assert {**of_folder, "path": ""} == {**of_file, "path": ""}


def test_of_the_logs_of_a_glob_an_unreadable_one_is_left_out(tmp_path: Path) -> None:
    """One word that means several logs: the others are shown, exit code 3."""
    shutil.copy(BAG, tmp_path / "good.bag")
    (tmp_path / "empty.bag").write_bytes(b"")

    outcome = mpap("info", tmp_path / "*.bag")
    strict = mpap("info", tmp_path / "*.bag", "--strict")

    assert outcome.code == 3
    assert outcome.out.startswith("good.bag: ")
    assert "empty.bag: the file is empty; left out" in outcome.err
    assert (strict.code, strict.out) == (1, "")


def test_who_waits_is_told_how_far_it_is() -> None:
    """Up to the end of each log."""
    told: list[tuple[str, float | None, list[float]]] = []

    @contextmanager
    def progress(title: str, total_s: float | None) -> Iterator[Report]:
        done: list[float] = []
        told.append((title, total_s, done))
        yield lambda done_s, _: done.append(done_s)

    info(LogSelection(logs=(str(BAG), str(MCAP))), progress)

    assert [title for title, _, _ in told] == [f"read {BAG.name}", f"read {MCAP.name}"]
    for _, total_s, moments in told:
        assert moments == sorted(moments)
        assert total_s == pytest.approx(moments[-1], abs=1.0)
