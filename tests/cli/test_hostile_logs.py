"""Names in logs and of logs lead nowhere outside OUT, and nothing raw reaches a terminal."""

import json
import logging
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mcap.writer import Writer

from mpap_cli.logs.reader import open_log

FIXTURES = Path(__file__).parents[2] / "fixtures"
NASTY = "\x1b[2J\x1b]0;title\x07\r\n../../../etc/x\u202e\x9b31m"
FILE_NAMES = (
    "..\x1b[31m\nmpap: forged line\r.mcap",
    "...mcap",
    "-o.mcap",
    "no text \udcff.mcap",
    "%s {0} $(id) $\\frac$ `id` \u202e.mcap",
    "\u65e5\u672c \U0001f916.mcap",
)

Run = Callable[..., Any]


def is_harmless(text: str) -> bool:
    """Whether a terminal only shows the text, and every line is whole."""
    return all(sign.isprintable() for sign in text.replace("\n", ""))


def rewritten(source: Path, path: Path, suffix: str) -> Path:
    """Copy a ROS 2 log with something added to the name of each topic."""
    with open_log(source) as reader, path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        numbers = {}
        for topic in reader.topics:
            schema = writer.register_schema(topic.msgtype, "ros2msg", topic.definition.encode())
            name = topic.name + suffix
            numbers[topic.name] = writer.register_channel(name, topic.encoding, schema)
        for topic, stamp_ns, payload in reader.messages(list(numbers)):
            writer.add_message(numbers[topic.name], stamp_ns, payload, stamp_ns)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type
    return path


def names_in(folder: Path) -> set[str]:
    """Return all files below a folder."""
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("source", ["indoor-a2.mcap", "camera-a.mcap"])
def test_topics_with_odd_names_do_no_harm(tmp_path: Path, run: Run, source: str) -> None:
    """Paths and escapes in topics are printed harmlessly and name no file."""
    log = rewritten(FIXTURES / source, tmp_path / "log.mcap", NASTY)
    out = tmp_path / "out"

    outcomes = [
        run("info", log),
        run("learn", log, "--end", "12", "-o", out),
        run("predict", out, log, "--end", "6", "--to-mcap", "-o", out),
        run("novelty", log, "--end", "12", "-o", out),
        run("info", out),
    ]
    told = json.loads(run("info", log, "--format", "json").out)

    assert [outcome.code for outcome in outcomes] == [0] * 5
    assert all(is_harmless(outcome.out + outcome.err) for outcome in outcomes)
    assert any(topic["name"].endswith(NASTY) for topic in told[0]["topics"])
    assert names_in(tmp_path) == {"log.mcap"} | {f"out/{name}" for name in names_in(out)}
    assert "0-log.mcap.mcap" in names_in(out / "predict")


@pytest.mark.parametrize("name", FILE_NAMES)
@pytest.mark.parametrize("source", ["indoor-a2.mcap", "camera-a.mcap"])
def test_logs_with_odd_names_do_no_harm(
    tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch, source: str, name: str
) -> None:
    """What a log is called is printed harmlessly and leads to no file outside OUT."""
    (tmp_path / "logs").mkdir()
    monkeypatch.chdir(tmp_path / "logs")
    # pytest's reports of several processes cannot hold a name that is no text
    monkeypatch.setattr(logging.getLogger("mpap_cli"), "propagate", False)
    shutil.copy(FIXTURES / source, name)
    out = tmp_path / "out"

    outcomes = [
        run("info", "--", name),
        run("learn", "--end", "12", "-o", out, "--", name),
        run("predict", "--end", "6", "--to-mcap", "-o", out, "--", out, name),
        run("novelty", "--end", "12", "-o", out, "--", name),
        run("info", out),
    ]
    data = [
        run("learn", "--end", "12", "-o", out, "--format", shape, "--", name)
        for shape in ("csv", "json")
    ]

    assert [outcome.code for outcome in (*outcomes, *data)] == [0] * 7
    assert all(is_harmless(outcome.out + outcome.err) for outcome in outcomes)
    assert not any("mpap: forged" in line[:12] for one in outcomes for line in one.err.splitlines())
    assert [path.name for path in (tmp_path / "logs").iterdir()] == [name]
    assert {path.name for path in tmp_path.iterdir()} == {"logs", "out"}
    assert {path.name for path in out.iterdir()} == {"learn", "predict", "novelty", "report.html"}
    assert all(file.replace("/", "").isascii() for file in names_in(out))
