"""Bumper messages become states of bumper sensors (section 4.1)."""

import re
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from typing import Any, NamedTuple

import numpy as np

from mpap_cli.errors import SettingError, UsageError
from mpap_cli.logs.bumps.bumper_rules import (
    BUMPER_RULES,
    BumpChoice,
    BumperRule,
    BumpKind,
    apply_choice,
    parse_bump_topic,
)
from mpap_cli.logs.bumps.expression import field_values, parse_expression
from mpap_cli.logs.fields import TimeSource
from mpap_cli.logs.layouts import header_stamps
from mpap_cli.logs.raw import LogReader, PayloadError, RawMessage, RawRun, Topic
from mpap_cli.observations import BoolArray, IntArray
from mpap_cli.params import BumperParams

__all__ = [
    "BUMPER_RULES",
    "BumpChoice",
    "BumpDecoder",
    "BumpKind",
    "BumpPiece",
    "BumperRule",
    "apply_choice",
    "parse_bump_topic",
]

_BROKEN = -1
_MAX_REMEMBERED = 1024
_MAX_REMEMBERED_BYTES = 256
_MOST_SIGNS = 256  # of a name: an expression takes longer than in proportion
_STAMPED_HEAD = 12  # ros1: sequence number and stamp; cdr: encapsulation and stamp


class BumpPiece(NamedTuple):
    """What messages of one topic tell, in log time order.

    ``recorded_ns`` (n,) is log time, ``stamps_ns`` (n,) the time wanted, ``codes`` (n,)
    twice the number of the sensor, plus 1 where it is pressed.
    """

    recorded_ns: IntArray
    stamps_ns: IntArray
    codes: IntArray

    def rows(self, rows: IntArray | BoolArray | slice) -> "BumpPiece":
        """Return some of the states."""
        return BumpPiece(self.recorded_ns[rows], self.stamps_ns[rows], self.codes[rows])


class BumpDecoder:
    """Turns the messages of one topic into states of its sensors.

    A payload that repeats the one before it (behind the stamp of its header) is passed over;
    of the others each distinct one is decoded once and remembered.

    Parameters
    ----------
    reader : LogReader
        Decodes the messages.
    rule : BumperRule
        What they say.
    params : BumperParams
        Names that do not count in simulated contacts.
    time_source : {"log", "header"}
        Which stamp the bumps get.
    prefix : str
        Put before the name of the sensor, where several topics are taken.
    sensors : dict of str to int, optional
        Numbers of the sensors; those met are added. Shared by the decoders of one log.
    """

    def __init__(
        self,
        reader: LogReader,
        rule: BumperRule,
        params: BumperParams,
        *,
        time_source: TimeSource = "log",
        prefix: str = "",
        sensors: dict[str, int] | None = None,
    ) -> None:
        self.rule = rule
        self._reader = reader
        self._pressed = _pressed_test(rule, params)
        self._use_header = time_source == "header"
        self._prefix = prefix
        self._sensors = {} if sensors is None else sensors
        self._remembered: dict[bytes, int] = {}
        self._stamped = False
        self._skip = 0

    def __call__(self, run: RawRun) -> tuple[BumpPiece, int]:
        """Return the states that messages tell, and how many do not fit their definition.

        Level: the sensor is the prefix, which is empty for one topic. Edge: it is the
        value of the sensor field. Pulse: ``pressed`` is False in a message that is no
        touch; it then says nothing about a release.

        Raises
        ------
        UsageError
            If a message has no field that the rule asks for, or no header whose stamp
            is wanted.
        LogError
            If the type has no definition.
        """
        from mpap_cli.logs.files import _kernels  # noqa: PLC0415  # numba is slow to import

        changes = _kernels.find_changes(run.records, run.starts, run.sizes, self._skip)
        begins = np.flatnonzero(changes).tolist()
        codes = np.full(len(run), _BROKEN)
        for begin, end in zip(begins, [*begins[1:], len(run)], strict=True):
            for number in range(begin, end):
                codes[number:end] = code = self._code(run, number)
                if code != _BROKEN:
                    break
        stamps_ns, whole = run.stamps_ns, codes != _BROKEN
        if self._use_header and whole.any():
            if not self._stamped:
                text = "no header, so --time-source header has no stamp to take; leave it at log"
                raise self._error(run.topic, text)
            stamps_ns, readable = header_stamps(run)
            whole &= readable
        piece = BumpPiece(run.stamps_ns, stamps_ns, codes).rows(whole)
        return piece, len(run) - len(piece.codes)

    def _code(self, run: RawRun, number: int) -> int:
        """Return the state that one message tells, or that it is broken."""
        payload = run.payload(number)
        code = self._remembered.get(payload[self._skip :])
        if code is None:
            try:
                decoded = self._reader.decode(
                    RawMessage(run.topic, int(run.stamps_ns[number]), payload)
                )
            except PayloadError:
                return _BROKEN
            code = self._interpret(run.topic, decoded)
            if len(payload) <= _MAX_REMEMBERED_BYTES:
                if len(self._remembered) >= _MAX_REMEMBERED:
                    self._remembered.clear()
                self._remembered[payload[self._skip :]] = code
        return code

    def _interpret(self, topic: Topic, decoded: object) -> int:
        """Return the state that a decoded message tells."""
        self._stamped = _is_stamped(decoded)
        if self._stamped and "header" not in self.rule.expression + self.rule.sensor_field:
            self._skip = _STAMPED_HEAD
        try:
            sensor = self._prefix + _sensor(decoded, self.rule.sensor_field)
            pressed = self._pressed(decoded)
        except UsageError as err:
            text = f"{err}; say what is pressed: --bump-topic {topic.name}:EXPR"
            raise self._error(topic, text) from err
        return 2 * self._sensors.setdefault(sensor, len(self._sensors)) + pressed

    def _error(self, topic: Topic, text: str) -> UsageError:
        return UsageError(f"{self._reader.path.name}: {topic.name} ({topic.msgtype}): {text}")


def _is_stamped(decoded: object) -> bool:
    """Tell whether a message begins with std_msgs/Header."""
    if not is_dataclass(decoded):
        return False
    first = next(iter(fields(decoded)), None)
    return first is not None and "Header" in str(first.type)


def _sensor(decoded: object, path: str) -> str:
    """Return the name of the sensor that a message speaks of."""
    return ",".join(str(value) for value in field_values(decoded, path)) if path else ""


def _pressed_test(rule: BumperRule, params: BumperParams) -> Callable[[object], bool]:
    """Build the test that a rule asks for."""
    if not rule.expression:
        return lambda _: True
    if not rule.ignore_fields:
        return parse_expression(rule.expression)
    try:
        ignored = re.compile(params.bump_ignore or r"(?!)", re.IGNORECASE)
    except re.error as err:
        msg = f"setting bump-ignore: found {params.bump_ignore}, expected a pattern: {err}"
        raise SettingError(msg) from None

    def counts(contact: Any) -> bool:
        names = (name for path in rule.ignore_fields for name in field_values(contact, path))
        return not any(ignored.search(str(name)[:_MOST_SIGNS]) for name in names)

    return lambda message: any(map(counts, field_values(message, rule.expression)))
