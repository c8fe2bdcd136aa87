"""How a command tells how far it is, without printing."""

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Protocol


class Report(Protocol):
    """Told the seconds of log time that are done, and the observations so far."""

    def __call__(self, done_s: float, n_observations: int) -> None:
        """Take both figures; called once a block."""
        ...


class Progress(Protocol):
    """Opens the report of one piece of work, of so many seconds of log time."""

    def __call__(self, title: str, total_s: float | None) -> AbstractContextManager[Report]:
        """Return the context in which the work is done."""
        ...


@contextmanager
def no_progress(title: str, total_s: float | None) -> Iterator[Report]:  # noqa: ARG001  # as Progress has it
    """Report to nobody."""
    yield _ignore


def _ignore(done_s: float, n_observations: int) -> None:
    """Take both figures, tell nobody."""
