"""Stages of the pipeline that overlap in threads, with bounded queues between them."""

import threading
from collections.abc import Generator, Iterable, Iterator
from queue import Queue
from time import monotonic
from typing import Generic, TypeVar

T = TypeVar("T")

PATIENCE_S = 0.25
"""So long whoever stops early waits for the thread, which may hang on a web server."""


def prefetch(items: Iterable[T], jobs: int, depth: int = 2) -> Iterator[T]:
    """Make items ahead of their use, in a thread of their own.

    Parameters
    ----------
    items : iterable
        Read in the background, by one thread only.
    jobs : int
        1: no thread, items are made when they are asked for; 2 or more: one thread.
    depth : int
        Most items that wait, 1 or more.

    Yields
    ------
    object
        The items in their order. An exception of ``items`` is raised where it would have
        come. Who stops early closes the thread with the generator; a thread that still waits
        for its item after `PATIENCE_S` is left behind, and ends when it has it.

    Examples
    --------
    >>> list(prefetch("abc", jobs=2))
    ['a', 'b', 'c']
    """
    if jobs <= 1:
        yield from items
        return
    worker = _Worker(items, depth)
    worker.thread.start()
    try:
        yield from worker.take()
    finally:
        worker.stop()


class _Worker(Generic[T]):
    """One thread that fills a bounded queue."""

    def __init__(self, items: Iterable[T], depth: int) -> None:
        self._items = items
        self._queue: Queue[tuple[T] | None] = Queue(depth)
        self._stopped = threading.Event()
        self._error: BaseException | None = None
        self.thread = threading.Thread(target=self._run, name="mpap-prefetch", daemon=True)

    def _run(self) -> None:
        """Fill the queue until the items end or nobody wants them any more."""
        try:
            for item in self._items:
                if self._stopped.is_set():
                    break
                self._queue.put((item,))
            if isinstance(self._items, Generator):
                self._items.close()
        except BaseException as error:  # noqa: BLE001  # raised again in the other thread
            self._error = error
        if not self._stopped.is_set():
            self._queue.put(None)

    def take(self) -> Iterator[T]:
        """Yield what the thread made, then raise what it raised."""
        while (entry := self._queue.get()) is not None:
            yield entry[0]
        if self._error is not None:
            raise self._error

    def stop(self) -> None:
        """End the thread: it may hang on a full queue, so empty that until it is done."""
        self._stopped.set()
        deadline_s = monotonic() + PATIENCE_S
        while self.thread.is_alive() and monotonic() < deadline_s:
            while not self._queue.empty():
                self._queue.get()
            self.thread.join(timeout=0.01)
