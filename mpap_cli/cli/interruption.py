"""Ctrl-C, and whatever else ends a run from outside: it stops, and leaves nothing half done."""

import math
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

INTERRUPTED = 130
_ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_AGAIN_S = 1.0
_RETRY_S = 0.005


class _Interrupt:
    """A handler of signals that raises KeyboardInterrupt; ``has_come`` tells whether it did."""

    def __init__(self) -> None:
        self._last_s = -math.inf
        self._tell = sys.unraisablehook

    @property
    def has_come(self) -> bool:
        return self._last_s > -math.inf

    def __call__(self, _number: int, _frame: FrameType | None) -> None:
        before_s, self._last_s = self._last_s, time.monotonic()
        if self._last_s - before_s > _AGAIN_S:
            raise KeyboardInterrupt

    def retry(self, lost: "sys.UnraisableHookArgs") -> None:
        """Raise it once more, a little later, where it was lost in a ``__del__`` or callback."""
        if not issubclass(lost.exc_type, KeyboardInterrupt):
            self._tell(lost)
            return
        self._last_s = -math.inf
        signal.signal(signal.SIGALRM, self)
        signal.setitimer(signal.ITIMER_REAL, _RETRY_S)


@contextmanager
def interruptible(*, to_the_end: bool = False) -> Iterator[_Interrupt]:
    """Let the signals that end a process raise KeyboardInterrupt, as Ctrl-C does.

    A signal that is ignored (``nohup``) stays so. What comes within a second of another is
    not raised: while the run removes what it began, impatient people press Ctrl-C again,
    and ``timeout`` sends its signal twice. With ``to_the_end`` they are ignored afterwards:
    all is done then, and what Python still tidies up is not to be cut short.
    """
    interrupt = _Interrupt()
    former = {number: signal.getsignal(number) for number in _ENDING}
    heeded = {number: old for number, old in former.items() if old not in {signal.SIG_IGN, None}}
    for number in heeded:
        signal.signal(number, interrupt)
    tell, sys.unraisablehook = sys.unraisablehook, interrupt.retry
    try:
        yield interrupt
    finally:
        sys.unraisablehook = tell
        if signal.getsignal(signal.SIGALRM) is interrupt:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
        for number, old in heeded.items():
            signal.signal(number, signal.SIG_IGN if to_the_end else old)


@contextmanager
def ended_by_signals(*, to_the_end: bool = False) -> Iterator[None]:
    """Turn what is raised because of a signal into one line and exit code 130.

    ``to_the_end`` is that of :func:`interruptible`. Inside of another one it does nothing.
    What a library makes of the KeyboardInterrupt (an import may turn it into an
    ImportError) is taken for what it is.
    """
    if isinstance(signal.getsignal(signal.SIGINT), _Interrupt):
        yield
        return
    with interruptible(to_the_end=to_the_end) as interrupt:
        try:
            yield
        except SystemExit:
            raise
        except BaseException as error:
            if not (interrupt.has_come or isinstance(error, KeyboardInterrupt)):
                raise
            sys.stderr.write("mpap: interrupted; results are whole, older or new\n")
            exec("")  # noqa: S102  # python -m ends by the signal if one went through an exec
            sys.exit(INTERRUPTED)
