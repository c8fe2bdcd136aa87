"""Several logs as one history: one clock, in the order given, gaps between logs removed."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.targets import Target
from mpap_cli.observations import IntArray, ObservedLog, Press

Presses = tuple[Press, ...]


@dataclass(frozen=True, slots=True, eq=False)
class History:
    """Where logs and presses lie on the common clock, in nanoseconds from its zero.

    ``start_ns`` (n_logs,) are the logs' own first stamps and ``offset_ns`` (n_logs,) where
    they begin in the history, which is ``length_ns`` long; ``press_log``,
    ``press_start_ns`` and ``press_end_ns`` (m,) are the presses in time order.
    """

    start_ns: IntArray
    offset_ns: IntArray
    length_ns: int
    press_log: IntArray
    press_start_ns: IntArray
    press_end_ns: IntArray

    @property
    def n_logs(self) -> int:
        """Number of logs."""
        return self.start_ns.size

    @property
    def n_presses(self) -> int:
        """Number of presses."""
        return self.press_log.size

    def times(self, log_index: IntArray, stamps_ns: IntArray) -> IntArray:
        """Return when stamps of logs, both (n,), are in the history."""
        return stamps_ns - self.start_ns[log_index] + self.offset_ns[log_index]

    def edges(self, n_parts: int) -> IntArray:
        """Cut the history into parts of about equally many presses.

        Parameters
        ----------
        n_parts : int
            From 1 to the number of presses.

        Returns
        -------
        ndarray of shape (n_parts - 1,)
            Inner edges, each midway between the end of one press and the start of the next.
        """
        parts = np.array_split(np.arange(self.n_presses), n_parts)
        first = np.array([part[0] for part in parts[1:]], dtype=np.int64)
        ends = np.maximum.accumulate(self.press_end_ns)
        return np.asarray((ends[first - 1] + self.press_start_ns[first]) // 2, dtype=np.int64)


def make_history(
    logs: Sequence[ObservedLog], presses: Sequence[Presses], target: Target
) -> History:
    """Put logs and the presses that the target can score on one clock.

    A press that is on in the first message has no onset: it counts under the target
    ``contact`` only.

    Examples
    --------
    >>> log = ObservedLog("a", "a", 50, 90, 0.0, None, (), "bumper", lambda: iter(()))
    >>> history = make_history([log, log], [(), (Press(60, 61),)], Target("contact"))
    >>> history.offset_ns.tolist(), history.press_start_ns.tolist()
    ([0, 41], [51])
    """
    lengths = np.array([log.end_ns - log.start_ns + 1 for log in logs], dtype=np.int64)
    offset_ns = np.cumsum(lengths) - lengths
    rows = [
        (index, press.start_ns - log.start_ns, press.end_ns - log.start_ns)
        for index, log in enumerate(logs)
        for press in sorted(presses[index], key=lambda press: press.start_ns)
        if target.name == "contact" or not press.held_from_start
    ]
    press_log, starts, ends = np.array(rows, dtype=np.int64).reshape(-1, 3).T
    return History(
        start_ns=np.array([log.start_ns for log in logs], dtype=np.int64),
        offset_ns=offset_ns,
        length_ns=int(lengths.sum()),
        press_log=press_log,
        press_start_ns=starts + offset_ns[press_log],
        press_end_ns=ends + offset_ns[press_log],
    )
