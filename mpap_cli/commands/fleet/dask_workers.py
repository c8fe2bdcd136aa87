"""The workers of a Dask cluster (extra ``dask``)."""

import logging
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from mpap_cli.commands.fleet.tasks import Finished, LeafTask, Outcome, Work, killed
from mpap_cli.errors import MpapError, UsageError

if TYPE_CHECKING:
    from distributed import Client

LOGGER = logging.getLogger(__name__)
DASK_EXTRA = 'pip install "mpap[dask]"'
_CONNECT_S = 10


def on_cluster(work: Work, tasks: Sequence[LeafTask], scheduler: str) -> Iterator[Finished]:
    """Work on all tasks on the workers of a scheduler, as :func:`workers.run_tasks` does.

    Raises
    ------
    MpapError
        If no scheduler answers.
    UsageError
        If Dask is not installed.

    Notes
    -----
    Tasks go to the scheduler one by one: joblib's own way to Dask waits forever for a task
    whose worker was killed.
    """
    client = _connect(scheduler)
    try:
        from distributed import as_completed  # noqa: PLC0415  # slow, and an extra

        if not client.ncores():
            LOGGER.warning("--scheduler %s: no worker yet; waiting for the first", scheduler)
        run = uuid4().hex
        futures = {
            client.submit(work, task, key=f"mpap-{task.number}-{run}", pure=False): task
            for task in tasks
        }
        finished = as_completed(futures, loop=client.loop, with_results=True, raise_errors=False)
        for future, result in finished:
            yield futures[future], _outcome(futures[future], future.status, scheduler, result)
    finally:
        client.close(timeout=1)


def _connect(scheduler: str) -> "Client":
    """Connect to a scheduler."""
    try:
        import dask  # noqa: PLC0415  # slow, and an extra
        from distributed import Client  # noqa: PLC0415
    except ModuleNotFoundError as err:
        msg = f"--scheduler needs Dask; {DASK_EXTRA}"
        raise UsageError(msg) from err
    dask.config.set({"distributed.comm.timeouts.connect": f"{_CONNECT_S}s"})
    for name in ("distributed", "distributed.client", "distributed.utils", "distributed.core"):
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)  # what matters is told here
    try:
        return Client(scheduler, timeout=_CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as err:
        msg = f"--scheduler {scheduler}: no Dask scheduler answers; check the address"
        raise MpapError(msg) from err


def _outcome(task: LeafTask, status: str, scheduler: str, result: Any) -> Outcome:
    """Return what became of a task; ``result`` is an error where the task has none."""
    from distributed.scheduler import KilledWorker  # noqa: PLC0415  # slow, and an extra

    if isinstance(result, Outcome):
        return result
    error = result[1] if isinstance(result, tuple) else result
    if isinstance(error, KilledWorker):
        return killed(task)
    if isinstance(error, ImportError):
        reason = f"{task.name}: a worker of {scheduler} lacks mpap ({error}); install it there"
        return Outcome(reason=reason)
    if status == "error":
        raise error
    return Outcome(reason=f"{task.name}: the scheduler {scheduler} went away", pending=True)
