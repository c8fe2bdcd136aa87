"""What a shell and a terminal see: completion, colors, and none where they are unwelcome."""

import os
import pty
import select
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

FIXTURES = Path(__file__).parents[2] / "fixtures"
ASK = """
source <(mpap completion bash)
COMP_WORDS=({words}) COMP_CWORD={at}
_mpap_completion mpap
printf '%s\\n' "${{COMPREPLY[@]}}"
"""


@pytest.fixture
def path(tmp_path: Path) -> str:
    """Return a PATH on which ``mpap`` is this one."""
    script = tmp_path / "mpap"
    main = "from mpap_cli.cli.main import main; main()"
    script.write_text(f'#!/bin/sh\nexec "{sys.executable}" -c "{main}" "$@"\n')
    script.chmod(0o755)
    return f"{tmp_path}{os.pathsep}{os.environ['PATH']}"


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("mpap le", {"learn"}),
        ("mpap co", {"compare", "config", "completion"}),
        ("mpap evaluate --protocol leave", {"leave-one-log-out", "leave-one-group-out"}),
        ("mpap predict --to", {"--to-mcap"}),
        ("mpap learn --profile ''", {"robust", "paper"}),
        ("mpap info --format j", {"json"}),
        ("mpap completion f", {"fish"}),
    ],
)
def test_bash_completes_commands_options_and_their_values(
    path: str, words: str, wanted: set[str]
) -> None:
    """The script, sourced in bash, offers what fits the last word."""
    bash = shutil.which("bash")
    if bash is None:
        pytest.skip("there is no bash")

    text = ASK.format(words=words, at=len(words.split()) - 1)
    found = subprocess.run(  # noqa: S603  # the project's own command
        [bash, "--norc", "-c", text],
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )

    assert found.stderr == ""
    assert set(found.stdout.split()) == wanted


@pytest.mark.parametrize(
    "words", ["info fix", "learn day1.bag fix", "predict fix", "extract --model fix", "merge fix"]
)
def test_names_of_logs_and_models_are_completed(path: str, words: str) -> None:
    """The shell is told to offer files."""
    found = subprocess.run(
        ["mpap"],  # noqa: S607  # the one on the PATH given
        env={
            **os.environ,
            "PATH": path,
            "_MPAP_COMPLETE": "bash_complete",
            "COMP_WORDS": f"mpap {words}",
            "COMP_CWORD": str(len(words.split())),
        },
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )

    assert found.stdout == "file,fix\n"


def on_a_terminal(path: str, *words: object, **env: str) -> str:
    """Run ``mpap`` with a terminal for stdout and stderr and return what it shows."""
    ours, theirs = pty.openpty()
    plain = {name: value for name, value in os.environ.items() if name != "NO_COLOR"}
    with subprocess.Popen(  # noqa: S603  # the project's own command
        [shutil.which("mpap", path=path) or "mpap", *map(str, words)],
        stdin=subprocess.DEVNULL,
        stdout=theirs,
        stderr=theirs,
        env={**plain, "TERM": "xterm-256color", "COLUMNS": "200", **env},
    ) as running:
        os.close(theirs)
        shown = b""
        while select.select([ours], [], [], 60)[0]:
            try:
                part = os.read(ours, 65536)
            except OSError:  # Linux tells so that the other side is closed
                break
            if not part:
                break
            shown += part
    os.close(ours)
    assert running.returncode == 0
    return shown.decode()


def test_a_terminal_gets_colors(path: str) -> None:
    """A table on a terminal has a bold head."""
    assert "\x1b[1m" in on_a_terminal(path, "config")


@pytest.mark.parametrize("env", [{"NO_COLOR": "1"}, {"TERM": "dumb"}])
def test_no_color_is_kept_on_a_terminal(path: str, env: dict[str, str]) -> None:
    """With NO_COLOR, and on a dumb terminal, there is no escape code."""
    assert "\x1b" not in on_a_terminal(path, "config", **env)


@pytest.mark.parametrize("shape", ["csv", "json"])
def test_what_programs_read_has_no_color_on_a_terminal(path: str, shape: str) -> None:
    """CSV and JSON are the same wherever they go."""
    assert "\x1b" not in on_a_terminal(path, "config", "--format", shape)


@pytest.mark.slow
def test_bars_are_for_terminals_without_no_color(path: str, tmp_path: Path) -> None:
    """Learning shows a bar on a terminal, with NO_COLOR only lines."""
    words = ("learn", FIXTURES / "indoor-a.bag", "-o", tmp_path / "out")

    colored, plain = on_a_terminal(path, *words), on_a_terminal(path, *words, NO_COLOR="1")

    assert "\x1b[" in colored
    assert "\x1b" not in plain
    assert "results: " in plain
