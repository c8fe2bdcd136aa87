"""Ctrl-C, and whatever else ends a run from outside: it stops, and leaves nothing half done."""

import math
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_AGAIN_S = 1.0


@contextmanager
def interruptible() -> Iterator[None]:
    """Let the signals that end a process raise KeyboardInterrupt, as Ctrl-C does.

    A signal that is ignored (``nohup``) stays so. What comes within a second of another is
    not raised: while the run removes what it began, impatient people press Ctrl-C again,
    and ``timeout`` sends its signal twice.
    """
    last_s = -math.inf

    def interrupt(_number: int, _frame: FrameType | None) -> None:
        nonlocal last_s
        before_s, last_s = last_s, time.monotonic()
        if last_s - before_s > _AGAIN_S:
            raise KeyboardInterrupt

    former = {number: signal.getsignal(number) for number in _ENDING}
    heeded = {number: old for number, old in former.items() if old not in {signal.SIG_IGN, None}}
    for number in heeded:
        signal.signal(number, interrupt)
    try:
        yield
    finally:
        for number, old in heeded.items():
            signal.signal(number, old)
