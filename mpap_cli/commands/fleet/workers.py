"""Workers that learn leaves: this process, others on this machine, or those of a cluster."""

import logging
import os
import threading
import time
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool

from mpap_cli.commands.fleet.tasks import Finished, LeafTask, Outcome, Work, killed
from mpap_cli.outputs.text_table import count

LOGGER = logging.getLogger(__name__)
_WATCH_S = 0.5
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def run_tasks(
    work: Work, tasks: Sequence[LeafTask], jobs: int, scheduler: str | None
) -> Iterator[Finished]:
    """Work on all tasks; what becomes of one does not touch the others.

    Parameters
    ----------
    work : callable
        Found by its name in the workers.
    tasks : sequence of LeafTask
        In whatever order.
    jobs : int
        Processes beside this one (loky, as joblib has it); 1: this process does the work.
    scheduler : str, optional
        Address of a Dask scheduler; its workers do the work instead.

    Yields
    ------
    tuple of LeafTask and Outcome
        As they finish.

    Raises
    ------
    MpapError
        If no scheduler answers, or Dask is not installed.
    """
    if not tasks:
        return
    if scheduler is not None:
        from mpap_cli.commands.fleet.dask_workers import on_cluster  # noqa: PLC0415  # slow: distributed

        yield from on_cluster(work, tasks, scheduler)
    elif jobs == 1:
        for task in tasks:
            yield task, work(task)
    else:
        yield from _in_processes(work, tasks, jobs)


def _in_processes(work: Work, tasks: Sequence[LeafTask], jobs: int) -> Iterator[Finished]:
    """Work in other processes; one that dies breaks the pool of them all.

    Which of the logs in work killed it cannot be told, so each is tried again alone.
    """
    waiting, suspects = deque(tasks), deque[LeafTask]()
    while waiting or suspects:
        if suspects:
            alone = deque([suspects.popleft()])
            suspects.extend((yield from _until_broken(work, alone, 1)))
        else:
            suspects.extend((yield from _until_broken(work, waiting, jobs)))
            if suspects:
                LOGGER.warning(
                    "a worker was killed; %s tried again one by one", count(len(suspects), "log")
                )


def _until_broken(
    work: Work, waiting: deque[LeafTask], jobs: int
) -> Generator[Finished, None, list[LeafTask]]:
    """Work on what waits until a process dies; return the logs that were in work then."""
    from joblib.externals.loky import ProcessPoolExecutor  # noqa: PLC0415  # seldom needed

    pool = ProcessPoolExecutor(
        min(jobs, len(waiting)), env=_ONE_THREAD, initializer=_end_with, initargs=(os.getpid(),)
    )
    flying: dict[Future[Outcome], LeafTask] = {}
    try:
        while waiting or flying:
            while waiting and len(flying) < jobs:
                flying[pool.submit(work, waiting[0])] = waiting[0]
                waiting.popleft()
            finished, _ = wait(flying, return_when=FIRST_COMPLETED)
            for future in finished:
                outcome = future.result()
                yield flying.pop(future), outcome
    except BrokenProcessPool:
        suspects = list(flying.values())
        if len(suspects) != 1:
            return suspects
        yield suspects[0], killed(suspects[0])
    finally:
        pool.shutdown(kill_workers=True)
    return []


def _end_with(parent: int) -> None:
    """Let a worker end soon after the process that started it, however that was ended."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(_WATCH_S)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
