"""Whatever ends a run from outside, it leaves older results whole and nothing else."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import click
import pytest

from benchmarks.robustness.interruptions import await_heed, cpu_s, end
from mpap_cli.cli.interruption import ended_by_signals, interruptible
from tests.file_server import serving

FIXTURES = Path(__file__).parents[2] / "fixtures"
LOG = str(FIXTURES / "indoor-a.bag")
CAMERA = str(FIXTURES / "camera-a.mcap")
MPAP = (sys.executable, "-m", "mpap_cli")
PATIENCE_S = 40.0
LINE = "mpap: interrupted; results are whole, older or new"
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


@contextmanager
def started(command: str, out: Path) -> Iterator["subprocess.Popen[str]"]:
    """Start a command and wait until it is in the middle of its work; nothing outlives it."""
    words = [command, *RUNS[command], "-o", str(out)]
    with subprocess.Popen(  # noqa: S603  # the project's own command
        [*MPAP, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as running:
        try:
            assert until((out / f".{command}.unfinished").exists)
            yield running
        finally:
            with suppress(ProcessLookupError):  # all of them have ended
                os.killpg(running.pid, signal.SIGKILL)


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


@pytest.mark.parametrize(
    "lost", [KeyboardInterrupt(), ImportError("no multiarray"), click.Abort()], ids=repr
)
def test_whatever_becomes_of_an_interruption_it_is_told(
    sent: list[int], capsys: pytest.CaptureFixture[str], lost: BaseException
) -> None:
    """Libraries turn the KeyboardInterrupt into errors of theirs."""

    def command() -> None:
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            raise lost from None

    with pytest.raises(SystemExit, match="130"), ended_by_signals(), ended_by_signals():
        command()

    assert capsys.readouterr().err == f"{LINE}\n"
    assert sent == []


def test_an_interruption_that_is_lost_comes_again(
    sent: list[int], capsys: pytest.CaptureFixture[str]
) -> None:
    """What is raised in a ``__del__`` goes nowhere: a little later it is raised once more."""

    class Dying:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGINT)

    def command() -> None:
        Dying()
        time.sleep(5)

    with pytest.raises(SystemExit, match="130"), ended_by_signals():
        command()

    assert capsys.readouterr().err == f"{LINE}\n"
    assert signal.getsignal(signal.SIGALRM) is signal.SIG_DFL
    assert sent == []


@pytest.mark.parametrize("delay_s", [0.0, 0.02, 0.05, 0.1, 0.2])
def test_an_interruption_while_python_imports(tmp_path: Path, delay_s: float) -> None:
    """From the first lines on it is one line and exit code 130."""
    words = [*MPAP, "learn", LOG, "-o", str(tmp_path / "out")]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as running:  # noqa: S603
        await_heed(running)
        time.sleep(delay_s)

        ended = end(running)

    assert ended.code == 130
    assert ended.is_clean, ended.said
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_an_interruption_while_a_server_hangs(tmp_path: Path, jobs: str) -> None:
    """Nobody waits for the answer, nor for the thread that does."""
    with serving(FIXTURES, wait_s=0.1) as server:
        words = [*MPAP, "learn", f"{server.url}/indoor-a.bag", "--jobs", jobs]
        with subprocess.Popen(  # noqa: S603  # the project's own command
            [*words, "-o", str(tmp_path / "out")], stderr=subprocess.PIPE, text=True
        ) as running:
            assert until(lambda: len(server.asked) > 3)
            server.manners.wait_s = 4 * PATIENCE_S
            assert until(lambda: len(server.asked) > 4)

            ended = end(running)

    assert ended.code == 130
    assert ended.is_clean, ended.said
    assert ended.wall_s < PATIENCE_S / 4
    assert ended.cpu_s < 1


@pytest.mark.slow
@pytest.mark.parametrize("command", RUNS)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_command_leaves_nothing(
    tmp_path: Path, command: str, number: signal.Signals
) -> None:
    """Exit code 130 and one line soon; no half results, no lock, no child process."""
    out = tmp_path / "out"
    with started(command, out) as running:
        if command == "reproduce":
            assert until(lambda: len(children_of(running.pid)) > 1)
        time.sleep(0.3)
        children = children_of(running.pid)
        busy_s = sum(map(cpu_s, children))

        ended = end(running, number)

        assert ended.cpu_s - busy_s < 1  # a second of the clock where nothing else runs
        assert ended.code == 130
        assert ended.is_clean, ended.said
        assert not out.exists()
        assert until(lambda: not are_alive(children))


@pytest.mark.slow
def test_the_workers_of_a_killed_run_end(tmp_path: Path) -> None:
    """A worker whose parent was killed does not wait for ever for what to do next."""
    with started("reproduce", tmp_path / "out") as running:
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
        [sys.executable, "-c", script, *words],
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )

    assert ended.returncode == 0
    assert "Traceback" not in ended.stderr
    assert (tmp_path / "out" / "learn" / "settings.json").is_file()
