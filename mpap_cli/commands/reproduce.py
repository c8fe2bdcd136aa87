"""``reproduce``: the tables and figures of the paper, beside its numbers."""

import logging
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from logging.handlers import QueueHandler, QueueListener
from multiprocessing.context import SpawnContext
from multiprocessing.queues import Queue
from pathlib import Path
from typing import Any

from mpap_cli.commands.reproducing.bench import Bench, Found
from mpap_cli.commands.reproducing.experiments import EXPERIMENTS, Experiment
from mpap_cli.commands.reproducing.request import ReproduceRequest
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.reproduced import ITEMS, Finding, Picture, ReproducedRow
from mpap_cli.logs.reader import expand_paths
from mpap_cli.logs.scratch import ScratchFolder
from mpap_cli.outputs.report.page import redraw
from mpap_cli.outputs.reproduced_text import markdown
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.tables import write_csv

__all__ = ["ReproduceRequest", "Reproduced", "reproduce"]

LOGGER = logging.getLogger(__name__)
_PACKAGE = "mpap_cli"
_N_NOVELTY = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Reproduced:
    """What was found, and where it lies; everything in the order of ``ITEMS``."""

    folder: Path
    rows: list[ReproducedRow]
    pictures: list[Picture]
    findings: list[Finding]
    exit_code: int = 0


def reproduce(request: ReproduceRequest) -> Reproduced:
    """Make the tables and figures of section 5 on data that the tool makes or the user names.

    Parameters
    ----------
    request : ReproduceRequest
        Results folder, data, parts.

    Returns
    -------
    Reproduced
        Numbers beside the paper's. ``reproduced.csv`` holds the numbers,
        ``reproduced.md`` the tables, pictures and findings.

    Raises
    ------
    UsageError
        If a part does not exist, or the logs of the novelty experiment are not three.
    LogError
        If data that were named cannot be read.
    OutputError
        If the results folder cannot be written.

    Notes
    -----
    With more than one job the experiments run in new processes: a script that calls this
    does so below ``if __name__ == "__main__":``.
    """
    _check(request)
    keep_kernels_writable()
    chosen = [one for one in EXPERIMENTS if one.wanted(request.only)]
    with ResultsFolder(request.out, "reproduce") as results, _scratch() as scratch:
        figures = results.path("reproduced.csv").parent
        benches = [
            Bench(one.name, request, one.wanted(request.only), figures, scratch / one.name)
            for one in chosen
        ]
        names = ", ".join(bench.experiment for bench in benches)
        LOGGER.info("experiments, %d at a time: %s", min(request.jobs, len(benches)), names)
        found = _run_all(benches, request.jobs)
        rows, pictures, findings = _in_order(found)
        write_csv(results.path("reproduced.csv"), ReproducedRow, rows)
        text = markdown(rows, pictures, findings)
        results.path("reproduced.md").write_text(text, encoding="utf-8")
        inputs = [item for one in found for item in one.inputs]
        results.commit(_values(request), inputs, request.seed)
    redraw(request.out)
    return Reproduced(
        folder=results.folder,
        rows=rows,
        pictures=pictures,
        findings=findings,
        exit_code=max((one.exit_code for one in found), default=0),
    )


def _check(request: ReproduceRequest) -> None:
    """Refuse what cannot be done before minutes are spent."""
    unknown = [item for item in request.only if item not in ITEMS]
    if unknown:
        msg = f"--only {unknown[0]}: no such part; choose from {', '.join(ITEMS)}"
        raise UsageError(msg)
    words = request.novelty
    if words and len(words) != _N_NOVELTY:
        msg = f"--novelty: found {len(words)} logs, expected three: A, B and A again"
        raise UsageError(msg)
    for word in (*request.indoor, *request.outdoor, *words):
        expand_paths([word])


def _values(request: ReproduceRequest) -> dict[str, object]:
    """Return all that can change results, for settings.json; inputs are listed beside it."""
    return {
        "seeds": request.seeds,
        "only": sorted(request.only),
        "short": request.short,
        "textures": request.textures is not None,
        "indoor": len(request.indoor),
        "outdoor": len(request.outdoor),
        "novelty": len(request.novelty),
    }


@contextmanager
def _scratch() -> Iterator[Path]:
    """Give a folder for what is thrown away."""
    folder = ScratchFolder("mpap-reproduce-")
    try:
        yield folder.path
    finally:
        folder.remove()


def _in_order(
    found: Sequence[Found],
) -> tuple[list[ReproducedRow], list[Picture], list[Finding]]:
    """Join what the experiments found, item after item."""
    titles = [item.title for item in ITEMS.values()]
    keys = list(ITEMS)
    rows = [row for one in found for row in one.rows]
    pictures = [picture for one in found for picture in one.pictures]
    findings = [finding for one in found for finding in one.findings]
    rows.sort(key=lambda row: titles.index(row.item.partition(", ")[0]))
    pictures.sort(key=lambda picture: keys.index(picture.item))
    findings.sort(key=lambda finding: keys.index(finding.item))
    return rows, pictures, findings


def _run_all(benches: Sequence[Bench], jobs: int) -> list[Found]:
    """Run the experiments, side by side if there are jobs for that; the order is kept."""
    if jobs == 1 or len(benches) == 1:
        return [_run(bench) for bench in benches]
    context = multiprocessing.get_context("spawn")
    talk: Queue[Any] = context.Queue()
    listener = QueueListener(talk, *logging.getLogger(_PACKAGE).handlers)
    listener.start()
    try:
        found = _run_in_pool(benches, jobs, context, talk)
    except BaseException:
        talk.cancel_join_thread()  # a worker that was ended may hold its lock for ever
        raise
    listener.stop()
    return found


def _run_in_pool(
    benches: Sequence[Bench], jobs: int, context: SpawnContext, talk: "Queue[Any]"
) -> list[Found]:
    """Run experiments in processes; none of them outlives an error or an interruption."""
    others = multiprocessing.active_children()
    with ProcessPoolExecutor(
        max_workers=min(jobs, len(benches)),
        mp_context=context,
        initializer=_begin_worker,
        initargs=(talk, logging.getLogger(_PACKAGE).level),
    ) as pool:
        longest = sorted(benches, key=lambda bench: -_named(bench.experiment).cost)
        try:
            waiting = {bench.experiment: pool.submit(_run, bench) for bench in longest}
            return [waiting[bench.experiment].result() for bench in benches]
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for worker in multiprocessing.active_children():
                if worker not in others:
                    worker.terminate()
            raise


def _begin_worker(talk: "Queue[Any]", level: int) -> None:
    """Send what a worker logs to the process that prints it, which alone is interrupted."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    logger = logging.getLogger(_PACKAGE)
    logger.handlers = [QueueHandler(talk)]
    logger.setLevel(level)
    keep_kernels_writable()


def _end_with_parent() -> None:
    """End this worker when the process that it works for has been killed."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _run(bench: Bench) -> Found:
    """Do one experiment, and tell how long it took."""
    experiment = _named(bench.experiment)
    bench.scratch.mkdir()
    began = time.perf_counter()
    with one_thread_each(), _only_progress():
        experiment.run(bench)
        bench.tell(f"{time.perf_counter() - began:.0f} s")
    return bench.found


def _named(name: str) -> Experiment:
    """Return the experiment of a name."""
    return next(one for one in EXPERIMENTS if one.name == name)


@contextmanager
def _only_progress() -> Iterator[None]:
    """Say nothing of the single steps inside an experiment but warnings."""
    package, ours = (
        logging.getLogger(_PACKAGE),
        logging.getLogger(f"{_PACKAGE}.commands.reproducing"),
    )
    before = package.level, ours.level
    ours.setLevel(before[0])
    package.setLevel(max(before[0], logging.WARNING))
    try:
        yield
    finally:
        package.setLevel(before[0])
        ours.setLevel(before[1])
