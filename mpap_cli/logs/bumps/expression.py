"""Tests on a message, as typed after ``--bump-topic TOPIC:``.

The grammar, from the loosest to the tightest binding::

    expression = all { "|" all }
    all        = test { "&" test }
    test       = path [ "&" whole number ] [ comparison literal ]
    path       = name [ "[]" ] { "." name [ "[]" ] }
    comparison = "==" | "!=" | "<=" | ">=" | "<" | ">"
    literal    = number | "inf" | "-inf" | "true" | "false"

``&`` before a number takes bits (``bumper & 7``), before a field it means "and". A path
that meets a list, with or without ``[]``, means any element of it. A test without a
comparison holds if the value is not zero, not empty and not false.
"""

import operator
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from numbers import Integral, Real
from typing import Any

import numpy as np

from mpap_cli.errors import SettingError, UsageError

_TOKEN = re.compile(
    r"\s*(?:(?P<number>[+-]?(?:inf\b|0x[0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?))"
    r"|(?P<path>[A-Za-z_]\w*(?:\[\])?(?:\.[A-Za-z_]\w*(?:\[\])?)*)"
    r"|(?P<sign>==|!=|<=|>=|<|>|&|\|))"
)
_COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<=": operator.le,
    ">=": operator.ge,
    "<": operator.lt,
    ">": operator.gt,
}
_TRUTH = {"true": 1.0, "false": 0.0}


@dataclass(frozen=True, slots=True)
class _Test:
    """One path with its bits and comparison; an empty comparison asks for truth."""

    path: str
    mask: int | None
    comparison: str
    literal: float

    def __call__(self, message: object) -> bool:
        """Tell whether any value at the path passes."""
        return any(self._passes(value) for value in field_values(message, self.path))

    def _passes(self, value: Any) -> bool:
        if self.mask is not None:
            if not isinstance(value, Integral | np.bool_):
                msg = f"field {self.path} is no whole number, so & {self.mask} has no meaning"
                raise UsageError(msg)
            value = int(value) & self.mask
        if not self.comparison:
            return bool(value)
        if not isinstance(value, Real | np.bool_):
            msg = f"field {self.path} is no number, so {self.comparison} cannot compare it"
            raise UsageError(msg)
        return bool(_COMPARISONS[self.comparison](value, self.literal))


def field_values(message: object, path: str) -> Iterator[Any]:
    """Yield every value that a path reaches; lists and arrays are walked through.

    Parameters
    ----------
    message : object
        A decoded message, or the mapping of one in JSON or protobuf.
    path : str
        Names joined by dots; ``[]`` after a name may mark a list.

    Yields
    ------
    object
        Numbers, booleans, texts or messages; nothing where a list on the way is empty.

    Raises
    ------
    UsageError
        If a message on the way has no such field.

    Examples
    --------
    >>> list(field_values({"wheels": [{"drop": 0}, {"drop": 1}]}, "wheels[].drop"))
    [0, 1]
    """
    values: list[Any] = [message]
    for name in path.replace("[]", "").split("."):
        values = [leaf for value in values for leaf in _leaves(_field(value, name, path))]
    yield from values


def _leaves(value: Any) -> Iterator[Any]:
    """Walk through lists and arrays of any depth."""
    if isinstance(value, list | tuple | np.ndarray):
        for element in value:
            yield from _leaves(element)
    else:
        yield value


def _field(value: Any, name: str, path: str) -> Any:
    """Read one field; the error lists the fields that there are."""
    if isinstance(value, Mapping):
        known = [str(key) for key in value]
    elif is_dataclass(value):
        known = [item.name for item in fields(value) if item.name != "__msgtype__"]
    else:
        known = []
    if name not in known:
        there = f"the fields are {', '.join(known)}" if known else "there are no fields there"
        msg = f"the message has no field {name} (asked for {path}); {there}"
        raise UsageError(msg)
    return value[name] if isinstance(value, Mapping) else getattr(value, name)


def parse_expression(text: str) -> Callable[[object], bool]:
    """Turn an expression into a test on decoded messages.

    Parameters
    ----------
    text : str
        An expression in the grammar of this module.

    Returns
    -------
    callable
        Takes a decoded message or the dict of a JSON message; raises `UsageError` if the
        message has no such field or its value cannot be compared.

    Raises
    ------
    SettingError
        If the text is no expression.

    Examples
    --------
    >>> parse_expression("bumper & 3")({"bumper": 4})
    False
    >>> parse_expression("detections[].type == 1")({"detections": [{"type": 2}, {"type": 1}]})
    True
    """
    tokens = _tokens(text)
    alternatives = [[_take_test(tokens, text)]]
    while tokens:
        kind, sign = tokens.pop(0)
        if kind != "sign" or sign not in {"&", "|"}:
            raise _syntax_error(text, sign, "& or |")
        if sign == "|":
            alternatives.append([])
        alternatives[-1].append(_take_test(tokens, text))
    return lambda message: any(all(test(message) for test in tests) for tests in alternatives)


def _tokens(text: str) -> list[tuple[str, str]]:
    """Cut the text into (kind, token)."""
    tokens: list[tuple[str, str]] = []
    stripped, place = text.rstrip(), 0
    while place < len(stripped):
        match = _TOKEN.match(stripped, place)
        if match is None or match.lastgroup is None:
            raise _syntax_error(text, stripped[place:].split()[0], "a field, a number or a sign")
        tokens.append((match.lastgroup, match.group(match.lastgroup)))
        place = match.end()
    return tokens


def _take_test(tokens: list[tuple[str, str]], text: str) -> _Test:
    """Take one test from the front of the tokens."""
    path = _take(tokens, "path", text, "a field name")
    mask: int | None = None
    if tokens[:1] == [("sign", "&")] and tokens[1:2] and tokens[1][0] == "number":
        bits = tokens[1][1]
        del tokens[:2]
        try:
            mask = int(bits, 0)
        except ValueError:
            raise _syntax_error(text, bits, "a whole number after &") from None
    if not tokens or tokens[0][1] not in _COMPARISONS:
        return _Test(path, mask, "", 0.0)
    comparison = tokens.pop(0)[1]
    if tokens and tokens[0][1] in _TRUTH:
        return _Test(path, mask, comparison, _TRUTH[tokens.pop(0)[1]])
    literal = _take(tokens, "number", text, "a number")
    value = float(int(literal, 0)) if "x" in literal.lower() else float(literal)
    return _Test(path, mask, comparison, value)


def _take(tokens: list[tuple[str, str]], kind: str, text: str, wanted: str) -> str:
    """Take one token of a kind from the front."""
    if not tokens or tokens[0][0] != kind:
        raise _syntax_error(text, tokens[0][1] if tokens else "the end", wanted)
    return tokens.pop(0)[1]


def _syntax_error(text: str, found: str, wanted: str) -> SettingError:
    msg = f"--bump-topic expression {text!r}: found {found}, expected {wanted}"
    return SettingError(msg)
