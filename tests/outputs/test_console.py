"""Tables and bars for people."""

import io
import json
from dataclasses import dataclass

import pytest

from mpap_cli.outputs.console import is_styled, print_rows, progress, shown, speed_text, table_text


@dataclass(frozen=True)
class Line:
    """A row of a table."""

    topic: str
    scans: int
    hz: float | None


ROWS = [Line("/scan", 157, 4.991), Line("[red]\x1b[31m", 9, None)]


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        """Say so."""
        return True


@pytest.fixture(autouse=True)
def _plain_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take away what would change the look."""
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.setenv("COLUMNS", "100")


def test_plain_table_is_aligned() -> None:
    """Numbers are flush right, and nothing in a name reaches the terminal."""
    text = table_text(Line, ROWS)

    assert text.splitlines() == [
        "topic       scans    hz",
        "/scan         157  4.99",
        "[red]?[31m      9     -",
    ]


def test_table_without_rows_has_a_header() -> None:
    """No row is no error."""
    assert table_text(Line, []) == "topic  scans  hz\n"


@pytest.mark.parametrize(("value", "text"), [(float("nan"), "-"), (False, "no"), ("a", "a")])
def test_values_are_shown(value: object, text: str) -> None:
    """Missing numbers are a dash, truth values words."""
    assert shown(value) == text


def test_nothing_is_styled_in_a_file() -> None:
    """A file gets plain text."""
    stream = io.StringIO()

    print_rows(Line, ROWS, "table", stream)

    assert stream.getvalue() == table_text(Line, ROWS)


@pytest.mark.parametrize(("name", "value"), [("NO_COLOR", "1"), ("TERM", "dumb")])
def test_no_color_is_respected(monkeypatch: pytest.MonkeyPatch, name: str, value: str) -> None:
    """With NO_COLOR, or on a dumb terminal, a terminal gets plain text too."""
    monkeypatch.setenv(name, value)
    stream = Terminal()

    print_rows(Line, ROWS, "table", stream)

    assert stream.getvalue() == table_text(Line, ROWS)


def test_empty_no_color_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """NO_COLOR counts when it is not empty, as no-color.org has it."""
    monkeypatch.setenv("NO_COLOR", "")

    assert is_styled(Terminal())


def test_terminal_gets_a_styled_table() -> None:
    """On a terminal the table is styled; names are neither markup nor commands."""
    stream = Terminal()

    print_rows(Line, ROWS, "table", stream)

    text = stream.getvalue()
    assert "\x1b[1m" in text
    assert "[red]?[31m" in text


@pytest.mark.parametrize("form", ["csv", "json"])
def test_machines_get_the_same_everywhere(form: str) -> None:
    """CSV and JSON are the same on a terminal and in a file."""
    streams = (Terminal(), io.StringIO())

    for stream in streams:
        print_rows(Line, ROWS, form, stream)

    first, second = (stream.getvalue() for stream in streams)
    assert first == second
    assert "\x1b[1m" not in first


def test_json_keeps_all_digits() -> None:
    """What is rounded for people is not rounded for machines."""
    stream = io.StringIO()

    print_rows(Line, ROWS, "json", stream)

    assert json.loads(stream.getvalue())[0]["hz"] == 4.991


def test_progress_is_silent_in_a_file() -> None:
    """No bar goes into a file."""
    stream = io.StringIO()

    with progress("day1.bag", 10.0, stream=stream) as report:
        report(5.0, 100)

    assert stream.getvalue() == ""


def test_progress_can_be_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    """Asked to be quiet, not even a terminal gets a bar; without a stream it is stderr."""
    with progress("day1.bag", 10.0, quiet=True, stream=Terminal()) as report:
        report(5.0, 100)
    with progress("day1.bag", 10.0) as report:
        report(5.0, 100)

    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("total_s", [10.0, None])
def test_progress_shows_on_a_terminal(total_s: float | None) -> None:
    """A terminal sees title and speed; a name is not read as markup."""
    stream = Terminal()

    with progress("[bold]day1.bag", total_s, stream=stream) as report:
        report(5.0, 100)

    assert "[bold]day1.bag" in stream.getvalue()
    assert "x real time" in stream.getvalue()


def test_speed_needs_time() -> None:
    """At the very start there is no speed yet."""
    assert speed_text(0.0, 0, 0.0) == ""
