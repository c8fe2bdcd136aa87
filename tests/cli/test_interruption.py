"""Whatever ends a run from outside, it leaves older results whole and nothing else."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from mpap_cli.cli.interruption import interruptible

FIXTURES = Path(__file__).parents[2] / "fixtures"
LOG = str(FIXTURES / "indoor-a.bag")
CAMERA = str(FIXTURES / "camera-a.mcap")
MPAP = (sys.executable, "-c", "from mpap_cli.cli.main import main; main()")
PATIENCE_S = 40.0
RUNS = {
    "learn": (CAMERA,) * 4,
    "evaluate": (LOG,),
    "novelty": (CAMERA, CAMERA),
    "reproduce": ("--only", "table-4,figure-7", "--seeds", "5"),
}


@pytest.fixture
def sent() -> Iterator[list[int]]:
    """Return what handlers of the caller's own were told; they are put back afterwards."""
    told: list[int] = []
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = [signal.signal(number, lambda got, _: told.append(got)) for number in numbers]
    yield told
    for number, handler in zip(numbers, before, strict=True):
        signal.signal(number, handler)


def until(holds: Callable[[], object]) -> bool:
    """Wait until something holds; false if it never does."""
    deadline = time.monotonic() + PATIENCE_S
    while not holds():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.01)
    return True


def start(command: str, out: Path, *more: str) -> "subprocess.Popen[str]":
    """Start a command and wait until it is in the middle of its work."""
    words = [command, *RUNS[command], *more, "-o", str(out)]
    running = subprocess.Popen(  # noqa: S603  # the project's own command
        [*MPAP, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert until((out / f".{command}.unfinished").exists)
    return running


def children_of(process: int) -> set[int]:
    """Return the processes that a process has started."""
    listed = Path(f"/proc/{process}/task/{process}/children").read_text(encoding="ascii")
    return {int(word) for word in listed.split()}


def are_alive(processes: set[int]) -> bool:
    """Whether any of the processes still runs."""
    states = [Path(f"/proc/{process}/stat") for process in processes]
    return any(state.exists() and ") Z " not in state.read_text() for state in states)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_signals_end_a_run_as_ctrl_c_does(sent: list[int], number: signal.Signals) -> None:
    """Inside, the first raises KeyboardInterrupt and a second is not heeded; all is put back."""
    with interruptible():
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(number)
        signal.raise_signal(signal.SIGTERM)
    signal.raise_signal(number)

    assert sent == [number]


def test_an_ignored_signal_stays_ignored(sent: list[int]) -> None:
    """Runs under nohup outlive the terminal."""
    signal.signal(signal.SIGHUP, signal.SIG_IGN)

    with interruptible():
        signal.raise_signal(signal.SIGHUP)

    assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    assert sent == []


@pytest.mark.slow
@pytest.mark.parametrize("command", RUNS)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_command_leaves_nothing(
    tmp_path: Path, command: str, number: signal.Signals
) -> None:
    """Exit code 130 and one line soon; no half results, no lock, no child process."""
    out = tmp_path / "out"
    running = start(command, out)
    if command == "reproduce":
        assert until(lambda: len(children_of(running.pid)) > 1)
    time.sleep(0.3)
    children = children_of(running.pid)

    asked = time.monotonic()
    running.send_signal(number)
    _, err = running.communicate(timeout=PATIENCE_S)

    assert time.monotonic() - asked < 3  # a second where nothing else runs
    assert (running.returncode, err.splitlines()[-1]) == (
        130,
        "mpap: interrupted; results are whole, older or new",
    )
    assert "Traceback" not in err
    assert not out.exists()
    assert until(lambda: not are_alive(children))


@pytest.mark.slow
def test_the_workers_of_a_killed_run_end(tmp_path: Path) -> None:
    """A worker whose parent was killed does not wait for ever for what to do next."""
    running = start("reproduce", tmp_path / "out")
    assert until(lambda: len(children_of(running.pid)) > 1)
    time.sleep(1)
    children = children_of(running.pid)

    os.kill(running.pid, signal.SIGKILL)
    running.communicate(timeout=PATIENCE_S)

    assert until(lambda: not are_alive(children))


@pytest.mark.parametrize("closed", ["stdout", "stderr"])
def test_a_closed_stream_is_no_error(tmp_path: Path, closed: str) -> None:
    """Who wants to hear nothing may close the stream."""
    descriptor = {"stdout": 1, "stderr": 2}[closed]
    script = f"import os, sys; os.close({descriptor}); os.execv(sys.argv[1], sys.argv[1:])"
    words = [*MPAP, "learn", LOG, "--end", "20", "-o", str(tmp_path / "out")]

    ended = subprocess.run(  # noqa: S603  # the project's own command
        [sys.executable, "-c", script, *words], capture_output=True, text=True, check=False
    )

    assert ended.returncode == 0
    assert "Traceback" not in ended.stderr
    assert (tmp_path / "out" / "learn" / "settings.json").is_file()
