"""The two clocks of a log: log time and the stamps of headers."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from mpap_cli.logs.fields import LOCATED, FieldError, scan_view
from mpap_cli.logs.frames import frame_view
from mpap_cli.logs.layouts import header_stamps
from mpap_cli.logs.listing import messages_of
from mpap_cli.logs.odometry import locate_pose
from mpap_cli.logs.raw import LogReader, RawMessage, RawRun, Topic
from mpap_cli.logs.times import is_date
from mpap_cli.observations import NS_PER_S

HEADED = frozenset(
    {
        "sensor_msgs/msg/LaserScan",
        "sensor_msgs/msg/CompressedImage",
        "sensor_msgs/msg/Image",
        "nav_msgs/msg/Odometry",
    }
)
"""Types whose messages begin with std_msgs/Header."""

_JUMP_NS = NS_PER_S
_PAUSE_NS = 5 * NS_PER_S
_LIMITS_NS = np.array([_JUMP_NS, _PAUSE_NS])
_MOST_PAUSES = 0.5  # of the messages: else they come that seldom
_HEADER_STAMPS: dict[str, Callable[[RawMessage], int]] = {
    "scan": lambda message: scan_view(message, "header")[0],
    "image": lambda message: (
        frame_view(message.topic, memoryview(message.payload), 0, "header").stamp_ns
    ),
    "odometry": lambda message: locate_pose(message.payload, message.topic.encoding).header_ns,
}


def clock_shift_ns(reader: LogReader, topics: Mapping[str, Topic]) -> int:
    """Tell how far the clock of the headers is from log time, by the first message.

    Parameters
    ----------
    reader : LogReader
        An open log.
    topics : mapping of str to Topic
        By sensor: scan, image, odometry; the first with a message that can be read tells.

    Returns
    -------
    int
        Nanoseconds to add to log time; 0 where no message tells.
    """
    for sensor, topic in topics.items():
        for message in messages_of(reader, topic):
            try:
                return _HEADER_STAMPS[sensor](message) - message.stamp_ns
            except FieldError:
                continue
    return 0


def out_of_turn(reader: LogReader, before: LogReader) -> str:
    """Say how a log does not follow the one given before it; empty if it does.

    Simulations start at 0, so that their logs share stamps without sharing time.
    """
    if reader.start_ns < before.start_ns:
        return "starts before the log given before it"
    over_s = (before.end_ns - reader.start_ns) / NS_PER_S
    if over_s <= 0 or not is_date(before.start_ns):
        return ""
    return f"starts {over_s:.1f} s before {before.path.name} ends; what both hold counts twice"


class _Events(NamedTuple):
    """How often something happened, when first, and how long it was at most."""

    n: int
    first_ns: int
    most_ns: int


class ClockWatch:
    """Watches the messages of one topic, in log time order.

    Parameters
    ----------
    name : str
        The topic.
    start_ns : int
        Log time from which moments are told.

    Notes
    -----
    Between two messages both clocks go on by as much. Where they differ by more than a
    second, one of them was set, or messages were held up on their way to the recorder.
    """

    def __init__(self, name: str, start_ns: int) -> None:
        self._name = name
        self._start_ns = start_ns
        self._n_messages = self._n_unset = 0
        self._last_ns = np.array([-1, 0, 0], dtype=np.int64)
        self._found = np.zeros((3, 3), dtype=np.int64)  # jumps, pauses, falls

    def add(self, run: RawRun) -> None:
        """Look at the stamps of the next messages."""
        from mpap_cli.logs import _kernels  # noqa: PLC0415  # numba is slow to import

        self._n_messages += len(run)
        own_ns, is_set = run.stamps_ns, np.ones(len(run), dtype=np.bool_)
        if run.topic.msgtype in HEADED and run.topic.encoding in LOCATED:
            own_ns, readable = header_stamps(run)
            near_start = run.stamps_ns < _JUMP_NS  # of a simulation, where 0 is a stamp
            is_set = readable & ((own_ns != 0) | near_start)
            self._n_unset += int(readable.sum() - is_set.sum())
        _kernels.measure_steps(
            run.stamps_ns, own_ns, is_set, self._last_ns, _LIMITS_NS, self._found
        )

    def findings(self) -> tuple[str, ...]:
        """Say what is odd, one sentence a kind; empty if nothing is."""
        jumps, pauses, falls = (_Events(*row) for row in self._found.tolist())
        found = []
        if self._n_unset:
            found.append(f"{self._n_unset:,} of {self._n_messages:,} headers have no stamp")
        if falls.n:
            found.append(f"header stamps fall {_times(falls.n)}")
        if jumps.n:
            longest = f"by up to {jumps.most_ns / NS_PER_S:,.1f} s"
            at = f"first at {self._seconds(jumps)}"
            times = _times(jumps.n)
            found.append(f"header stamps and log time part {times}, {at}, {longest}")
        if 0 < pauses.n < _MOST_PAUSES * self._n_messages:
            longest = f"for up to {pauses.most_ns / NS_PER_S:,.1f} s"
            at = f"first at {self._seconds(pauses)}"
            found.append(f"pauses {_times(pauses.n)}, {at}, {longest}")
        return tuple(f"{self._name}: {words}" for words in found)

    def _seconds(self, events: _Events) -> str:
        """Tell the moment of the first event."""
        return f"{(events.first_ns - self._start_ns) / NS_PER_S:,.1f} s"


def _times(number: int) -> str:
    """Return a number of times in words."""
    return "once" if number == 1 else f"{number:,} times"
