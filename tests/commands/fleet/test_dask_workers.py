"""Workers of a Dask cluster in processes of its own."""

import json
import subprocess
import sys
import threading
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from mpap_cli.commands.fleet.workers import run_tasks
from tests.commands.fleet.logs import (
    DEADLY,
    LOGS,
    copied,
    learn_or_die,
    merged_bytes,
    n_done,
    states,
    wait_until,
)
from tests.commands.fleet.test_killed import tasks_of
from tests.commands.running import BAG, done, mpap

pytestmark = pytest.mark.slow


@pytest.fixture
def local_cluster() -> Iterator[Any]:
    """Return a cluster of two worker processes."""
    from distributed import LocalCluster  # noqa: PLC0415  # slow, and an extra

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what Dask does with its own event loops
        cluster = LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0"
        )
        yield cluster
        cluster.close()


def test_a_cluster_gives_the_same_bytes(local_cluster: Any, tmp_path: Path) -> None:
    """As one process does; the second time it has nothing to do."""
    done("learn", "--merge", *LOGS, "--jobs", "1", "-o", tmp_path / "one")

    words = ("--scheduler", local_cluster.scheduler_address, "-o", tmp_path / "many")
    first = done("learn", "--merge", *LOGS, *words)
    again = done("learn", "--merge", *LOGS, *words)

    assert merged_bytes(tmp_path / "many") == merged_bytes(tmp_path / "one")
    assert "learnt in" in first.err
    assert "4 logs learnt before" in again.err


def test_a_log_that_kills_workers_stops_no_other(local_cluster: Any, tmp_path: Path) -> None:
    """Dask gives it up after some workers; the other logs are learnt."""
    deadly = copied(BAG, tmp_path / "logs", DEADLY)
    tasks = tasks_of([LOGS[0], deadly, LOGS[1]], tmp_path / "leaves")

    run = run_tasks(learn_or_die, tasks, 2, local_cluster.scheduler_address)
    found = {task.name: outcome for task, outcome in run}

    assert {name for name, outcome in found.items() if outcome.leaf} == {
        LOGS[0].name,
        LOGS[1].name,
    }
    assert "the worker that read it was killed" in found[DEADLY].reason


def started(program: str, *words: str, file: Path) -> "subprocess.Popen[bytes]":
    """Start a part of a Dask cluster."""
    line = [sys.executable, "-m", f"distributed.cli.{program}", "--no-dashboard", *words]
    line += ["--scheduler-file", str(file)]
    return subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # noqa: S603  # Dask itself


@pytest.fixture
def lone_scheduler(tmp_path: Path) -> Iterator[tuple[str, "subprocess.Popen[bytes]"]]:
    """Return the address of a scheduler with one worker, and its process."""
    file = tmp_path / "scheduler.json"
    scheduler = started("dask_scheduler", "--port", "0", "--host", "127.0.0.1", file=file)
    wait_until(lambda: file.exists() and b"address" in file.read_bytes())
    worker = started("dask_worker", "--nthreads", "1", file=file)
    yield json.loads(file.read_bytes())["address"], scheduler
    for process in (worker, scheduler):
        process.terminate()
        process.wait()


def test_a_scheduler_that_goes_away_loses_nothing(
    lone_scheduler: tuple[str, "subprocess.Popen[bytes]"], tmp_path: Path
) -> None:
    """What was learnt is merged, the rest is pending (3); the next run learns only that."""
    address, scheduler = lone_scheduler
    out = tmp_path / "out"

    def kill() -> None:
        wait_until(lambda: n_done(out) > 0)
        scheduler.kill()

    killer = threading.Thread(target=kill)
    killer.start()
    broken = mpap("learn", "--merge", *LOGS, "--scheduler", address, "-o", out)
    killer.join()
    left = states(out)
    again = mpap("learn", "--merge", *LOGS, "--jobs", "1", "-o", out)

    assert (broken.code, again.code) == (3, 0)
    assert f"the scheduler {address} went away" in broken.err
    assert set(left.values()) == {"done", "pending"}
    there = {name for name, state in left.items() if state == "done"}
    assert all(f"{name}: learnt in" not in again.err for name in there)
