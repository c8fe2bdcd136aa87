"""Commands in Markdown pages, run again: what stands below each is what it prints."""

import os
import re
import runpy
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from mpap_cli.cli.main import main

ROOT = Path(__file__).parent.parent
ELLIPSIS = "..."
Run = Callable[[str], str]
_LINE = re.compile(
    r"mpap (?P<words>[^|;>]*?)(?P<both> 2>&1)?(?: > (?P<file>\S+))?(?: \| (?P<rest>.*?))?"
    r"(?P<told>; echo \"exit code \$\?\")?"
)


@pytest.fixture
def run_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Run:
    """Return a function that runs a command of a page beside the fixtures.

    It returns what goes to stdout. mpap and Python scripts run in this process, which need
    not start again each time; bash does what stands behind a pipe, and the rest. A page says
    so (``; echo "exit code $?"``) where a command does not end well.
    """
    (tmp_path / "fixtures").symlink_to(ROOT / "fixtures")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("MPAP_OUT", raising=False)

    def run(command: str) -> str:
        capsys.readouterr()
        if command.startswith("python "):
            runpy.run_path(command.removeprefix("python "), run_name="__main__")
            return capsys.readouterr().out
        line = _LINE.fullmatch(command)
        if line is None:
            return _bash(command)
        code, printed = _mpap(line["words"], capsys, both=line["both"] is not None)
        assert code == 0 or line["told"], command
        if line["file"]:
            Path(line["file"]).write_text(printed, encoding="utf-8")
            printed = ""
        if line["rest"]:
            return _bash(line["rest"] + (line["told"] or ""), printed)
        return printed + (f"exit code {code}\n" if line["told"] else "")

    return run


def _mpap(words: str, capsys: pytest.CaptureFixture[str], *, both: bool) -> tuple[int, str]:
    """Run ``mpap`` and return its exit code and what it prints."""
    with pytest.raises(SystemExit) as left:
        main(shlex.split(words))
    said = capsys.readouterr()
    return int(left.value.code or 0), (said.err if both else "") + said.out


def _bash(command: str, printed: str = "") -> str:
    """Run a line in bash, given what is piped into it."""
    shell = ["bash", "-o", "pipefail", "-c", f'python() {{ "{sys.executable}" "$@"; }}\n{command}']
    found = subprocess.run(shell, input=printed, capture_output=True, text=True, check=True)  # noqa: S603
    return found.stdout


def blocks_of(page: str) -> list[str]:
    """Return the ``console`` blocks of a page."""
    return re.findall(r"```console\n(.*?)```", page, re.DOTALL)


def check_page(path: Path, run: Run) -> list[str]:
    """Run every command of a page and return the blocks whose output differs.

    With MPAP_REWRITE_GOLDEN set the page is given the new output instead; blocks that hold
    ``...`` stay as they are.
    """
    page = path.read_text(encoding="utf-8")
    wrong = []
    for block in blocks_of(page):
        command, _, shown = block.partition("\n")
        printed = run(command.removeprefix("$ "))
        if is_shown(printed, shown):
            continue
        if os.environ.get("MPAP_REWRITE_GOLDEN") and ELLIPSIS not in shown.splitlines():
            page = page.replace(block, f"{command}\n{printed}")
        else:
            wrong.append(f"{command}\n{printed}")
    if page != path.read_text(encoding="utf-8"):
        path.write_text(page, encoding="utf-8")
    return wrong


def is_shown(printed: str, shown: str) -> bool:
    """Tell whether a page shows an output, where ``...`` stands for any lines."""
    parts = [re.escape(line) for line in shown.splitlines()]
    pattern = r"\n".join(r"(?:.*\n)*?.*" if part == re.escape(ELLIPSIS) else part for part in parts)
    return re.fullmatch(pattern, printed.rstrip("\n")) is not None
