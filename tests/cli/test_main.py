"""The command line as a process: quick to start, quiet where it is piped, easy to interrupt."""

import os
import platform
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any

import click
import pytest

from benchmarks.robustness.interruptions import end
from mpap_cli import __version__
from mpap_cli.cli.main import COMMANDS, mpap

FIXTURES = Path(__file__).parents[2] / "fixtures"
MPAP = (sys.executable, "-m", "mpap_cli")
LOADED = """
import sys
from mpap_cli.cli.main import main
try:
    main(sys.argv[1:])
except SystemExit as left:
    print("code", left.code or 0)
print("loaded", *(name for name in ("numpy", "rich", "numba", "cv2", "sklearn", "matplotlib",
                                    "rosbags", "mcap", "scipy") if name in sys.modules))
"""


def process(*words: object, **env: str) -> subprocess.CompletedProcess[str]:
    """Run ``mpap`` as a process of its own, its output piped."""
    return subprocess.run(  # noqa: S603  # the project's own command
        [*MPAP, *(str(word) for word in words)],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, **env},
        timeout=60,
    )


@pytest.mark.parametrize("words", [("--help",), ("--version",), ("learn", "--help"), ("mistake",)])
def test_help_and_version_import_nothing_heavy(words: tuple[str, ...]) -> None:
    """Neither numpy nor rich is needed to tell what there is."""
    found = subprocess.run(  # noqa: S603  # the project's own command
        [sys.executable, "-c", LOADED, *words], capture_output=True, text=True, check=True
    )

    assert found.stdout.splitlines()[-1] == "loaded"


def test_the_version_is_that_of_the_package(run: Callable[..., Any]) -> None:
    """One line: its own, Python's, and those of the packages that results depend on."""
    outcome = run("--version")

    assert outcome.code == 0
    found = re.fullmatch(r"mpap (\S+) \((.+)\)\n", outcome.out)
    assert found is not None
    assert found[1] == __version__
    versions = dict(part.split() for part in found[2].split(", "))
    assert versions.pop("Python") == platform.python_version()
    assert {"numpy", "rosbags", "mcap", "numba"} <= set(versions)
    assert all(metadata.version(name) == number for name, number in versions.items())


def test_the_help_lists_every_command_in_order(run: Callable[..., Any]) -> None:
    """Each command has a line that begins with a capital and ends with a full stop."""
    outcome = run("--help")

    listed = re.findall(r"^  ([a-z]+)  +([A-Z].*\.)$", outcome.out, re.MULTILINE)
    assert listed == list(COMMANDS.items())


@pytest.mark.parametrize("command", list(COMMANDS))
def test_every_command_explains_itself_by_an_example(run: Callable[..., Any], command: str) -> None:
    """The help ends with an example that can be pasted."""
    outcome = run(command, "--help")

    assert outcome.code == 0
    assert re.search(rf"^  Examples?:\n    mpap {command}\b", outcome.out, re.MULTILINE)


def test_the_examples_of_simulate_can_be_pasted(run: Callable[..., Any], tmp_path: Path) -> None:
    """Their worlds and bumpers exist."""
    text = run("simulate", "--help").out
    examples = re.findall(r"^    mpap simulate (\S+) (.*)$", text, re.MULTILINE)

    for name, words in examples:
        outcome = run("simulate", tmp_path / name, *words.split(), "--duration", "5")

        assert outcome.code == 0
    assert len(examples) == 3


@pytest.mark.parametrize("name", list(COMMANDS))
def test_every_option_has_a_text(name: str) -> None:
    """No option stands in the help without saying what it does."""
    command = mpap.get_command(click.Context(mpap), name)

    assert command is not None
    options = [one for one in command.params if isinstance(one, click.Option)]
    assert [one.name for one in options if not one.help] == []


@pytest.mark.parametrize("command", [(), *((name,) for name in COMMANDS)])
def test_an_unknown_option_is_a_usage_error(
    run: Callable[..., Any], command: tuple[str, ...]
) -> None:
    """It is named, with exit code 2 and nothing on stdout."""
    outcome = run(*command, "--no-such-option")

    assert outcome.code == 2
    assert "--no-such-option" in outcome.err
    assert outcome.out == ""


@pytest.mark.parametrize(
    "words",
    [
        ("teach",),
        ("learn",),
        ("predict",),
        ("completion", "tcsh"),
        ("learn", "log.bag", "--jobs", "0"),
        ("learn", "log.bag", "--feature", "smell"),
        ("evaluate", "--protocol", "luck"),
        ("evaluate", "--threshold", "2"),
    ],
)
def test_wrong_words_are_usage_errors(run: Callable[..., Any], words: tuple[str, ...]) -> None:
    """An unknown command, a missing argument or a value out of range end with exit code 2."""
    outcome = run(*words)

    assert outcome.code == 2
    assert "Traceback" not in outcome.err


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_prints_a_script(run: Callable[..., Any], shell: str) -> None:
    """The script calls mpap for the words that fit."""
    outcome = run("completion", shell)

    assert outcome.code == 0
    assert f"_MPAP_COMPLETE={shell}_complete" in outcome.out


def test_completion_knows_the_commands() -> None:
    """What the script asks for comes back as the commands that fit."""
    found = process(_MPAP_COMPLETE="bash_complete", COMP_WORDS="mpap le", COMP_CWORD="1")

    assert found.stdout.split() == ["plain,learn"]


@pytest.mark.parametrize("env", [{}, {"NO_COLOR": "1"}, {"FORCE_COLOR": "1"}])
def test_piped_output_has_no_escape_codes(env: dict[str, str]) -> None:
    """Neither color nor bars where nobody looks at a terminal."""
    found = process("config", **env)

    assert found.returncode == 0
    assert "\x1b" not in found.stdout + found.stderr
    assert "\r" not in found.stdout + found.stderr


@pytest.mark.slow
def test_learning_piped_has_no_escape_codes(tmp_path: Path) -> None:
    """Progress is for terminals; the table goes to stdout, talk to stderr."""
    found = process("learn", FIXTURES / "indoor-a.bag", "-o", tmp_path / "out")

    assert found.returncode == 0
    assert "\x1b" not in found.stdout + found.stderr
    assert all(line.startswith("mpap: ") for line in found.stderr.splitlines())
    assert not any(line.startswith("mpap: ") for line in found.stdout.splitlines())


def test_quiet_says_nothing_but_errors(run: Callable[..., Any], tmp_path: Path) -> None:
    """-q leaves stderr empty; an error is still told."""
    quiet = run("learn", "-q", FIXTURES / "indoor-a.bag", "-o", tmp_path / "out")
    wrong = run("learn", "-q", tmp_path / "missing.bag", "-o", tmp_path / "out")

    assert (quiet.code, quiet.err) == (0, "")
    assert wrong.code == 1
    assert "missing.bag" in wrong.err


def test_the_results_folder_can_come_from_the_environment(
    run: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """MPAP_OUT stands for --out."""
    monkeypatch.setenv("MPAP_OUT", str(tmp_path / "there"))

    outcome = run("learn", FIXTURES / "indoor-a.bag")

    assert outcome.code == 0
    assert (tmp_path / "there" / "learn" / "model.npz").is_file()


@pytest.mark.slow
def test_an_interrupted_run_leaves_older_results_whole(tmp_path: Path) -> None:
    """SIGINT while logs are learnt: exit code 130 soon, no half results."""
    out = tmp_path / "out"
    log = FIXTURES / "indoor-a.bag"
    assert process("learn", log, "-o", out).returncode == 0
    before = {path.name: path.read_bytes() for path in (out / "learn").iterdir()}
    for number in range(80):
        shutil.copy(log, tmp_path / f"{number}.bag")
    words = ["learn", str(tmp_path / "*.bag"), "-o", str(out)]
    running = subprocess.Popen(  # noqa: S603  # the project's own command
        [*MPAP, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    staged = out / ".learn.unfinished" / "recording.npz"
    deadline = time.monotonic() + 30
    while not (staged.exists() and staged.stat().st_size) and time.monotonic() < deadline:
        time.sleep(0.02)

    ended = end(running)

    assert ended.cpu_s < 1  # of the clock where nothing else runs
    assert ended.code == 130
    assert ended.is_clean, ended.said
    assert {path.name: path.read_bytes() for path in (out / "learn").iterdir()} == before
    assert {path.name for path in out.iterdir()} == {"learn", "report.html"}
