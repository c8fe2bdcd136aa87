"""Runs and workers that are killed lose nothing but what was in work."""

import os
import signal
from dataclasses import replace
from pathlib import Path

import pytest

from mpap_cli import __version__
from mpap_cli.commands.fleet.tasks import LeafTask
from mpap_cli.commands.fleet.workers import run_tasks
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.params import make_settings
from tests.commands.fleet.logs import (
    DEADLY,
    LOGS,
    children_of,
    copied,
    learn_or_die,
    manifest,
    merged_bytes,
    n_done,
    start,
    states,
    wait_until,
)
from tests.commands.running import BAG, done

pytestmark = pytest.mark.slow


def tasks_of(logs: list[Path], leaves: Path) -> list[LeafTask]:
    """Return a task for each log."""
    leaves.mkdir()
    return [
        LeafTask(
            number=number,
            path=log,
            described=None,
            leaves=leaves,
            selection=LogSelection(end="20"),
            settings=make_settings(values={"reference": "exemplar"}),
            presses=None,
            definitions="",
            keep_recording=True,
            version=__version__,
        )
        for number, log in enumerate(logs)
    ]


def test_a_log_that_kills_its_worker_stops_no_other(tmp_path: Path) -> None:
    """It is found out although the whole pool dies with the worker."""
    deadly = copied(BAG, tmp_path / "logs", DEADLY)
    tasks = tasks_of([LOGS[0], deadly, LOGS[1]], tmp_path / "leaves")

    found = {task.name: outcome for task, outcome in run_tasks(learn_or_die, tasks, 2, None)}

    assert {name for name, outcome in found.items() if outcome.leaf} == {
        LOGS[0].name,
        LOGS[1].name,
    }
    assert "the worker that read it was killed" in found[DEADLY].reason


def test_a_worker_of_another_version_learns_nothing(tmp_path: Path) -> None:
    """Leaves of two versions would not be the same."""
    task = replace(tasks_of([BAG], tmp_path / "leaves")[0], version="0.0.0")

    [(_, outcome)] = run_tasks(learn_or_die, [task], 1, None)

    assert f"the worker runs mpap {__version__}, this is 0.0.0" in outcome.reason


def test_a_killed_worker_is_replaced(tmp_path: Path) -> None:
    """SIGKILL of one worker: all logs are learnt, with the same result."""
    undisturbed, out = tmp_path / "undisturbed", tmp_path / "out"
    done("learn", "--merge", *LOGS, "--jobs", "1", "-o", undisturbed)

    with start(*LOGS, "--jobs", "2", "-o", out) as run:
        wait_until(lambda: any((out / "leaves").glob(".*.*/.*")) or run.poll() is not None)
        workers = [child for child in children_of(run.pid) if is_worker(child)]
        os.kill(workers[0], signal.SIGKILL)
        said = run.communicate()[1]

    assert run.returncode == 0, said
    assert "a worker was killed" in said
    assert merged_bytes(out) == merged_bytes(undisturbed)


def is_worker(process: int) -> bool:
    """Tell a worker from the process that tracks resources."""
    line = Path(f"/proc/{process}/cmdline").read_bytes()
    return b"loky" in line and b"resource_tracker" not in line


def test_a_killed_run_goes_on_where_it_stopped(tmp_path: Path) -> None:
    """SIGKILL of the run: the next one reads the missing logs only, with the same result."""
    undisturbed, out = tmp_path / "undisturbed", tmp_path / "out"
    done("learn", "--merge", *LOGS, "--jobs", "1", "-o", undisturbed)

    with start(*LOGS, "--jobs", "2", "-o", out) as run:
        wait_until(lambda: n_done(out) > 0 or run.poll() is not None)
        workers = [child for child in children_of(run.pid) if is_worker(child)]
        run.kill()
    wait_until(lambda: not any(Path(f"/proc/{worker}").exists() for worker in workers))
    there = {name for name, state in states(out).items() if state == "done"}
    again = done("learn", "--merge", *LOGS, "--jobs", "2", "-o", out)

    assert there
    assert workers
    assert all(f"{name}: learnt in" not in again.err for name in there)
    assert set(states(out).values()) == {"done"}
    assert merged_bytes(out) == merged_bytes(undisturbed)
    assert not list((out / "leaves").glob(".[0-9a-f]*"))
    assert set(manifest(out)) == {path.name for path in LOGS}
