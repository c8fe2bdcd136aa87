"""Messages as plain dictionaries become bytes: cdr, ros1 or JSON."""

import json
from collections.abc import Callable, Mapping
from importlib.resources import files
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import FieldDesc
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from mpap_cli.errors import UsageError

Message = Mapping[str, Any]

_NO_NUMPY = ("string", "wstring")
_JSON_DECIMALS = 6


class RosEncoder:
    r"""Serialises messages of types that rosbags or the built-in definitions know.

    A message is a mapping of its fields, nested messages likewise; a field that is left
    out is zero, empty or a message of such fields.

    Parameters
    ----------
    ros_version : int
        1 (ros1 bytes, definitions as a .bag holds them) or 2 (cdr).

    Examples
    --------
    >>> RosEncoder(1).encode("std_msgs/msg/Bool", {"data": True})
    b'\x01'
    """

    def __init__(self, ros_version: int) -> None:
        self.ros_version = ros_version
        self.store = get_typestore(Stores.ROS1_NOETIC if ros_version == 1 else Stores.ROS2_HUMBLE)
        self._makers: dict[str, Callable[[Message], object]] = {}

    def encode(self, msgtype: str, message: Message) -> bytes:
        """Return the bytes of one message.

        Parameters
        ----------
        msgtype : str
            Type in ROS2 form, as ``sensor_msgs/msg/LaserScan``.
        message : mapping
            Fields by name.

        Raises
        ------
        UsageError
            If there is no definition of the type, or it has no such field.
        """
        typed = self._maker(msgtype)(message)
        if self.ros_version == 1:
            return bytes(self.store.serialize_ros1(typed, msgtype))
        return bytes(self.store.serialize_cdr(typed, msgtype, little_endian=True))

    def definition(self, msgtype: str) -> tuple[str, str]:
        """Return text and hash (md5 for ROS1, RIHS01 for ROS2) of a type's definition."""
        self._learn(msgtype)
        text, md5 = self.store.generate_msgdef(msgtype, ros_version=self.ros_version)
        return text, md5 if self.ros_version == 1 else self.store.hash_rihs01(msgtype)

    def _learn(self, msgtype: str) -> None:
        """Register the built-in definition of a type and of all types inside it."""
        if msgtype in self.store.fielddefs:
            return
        name = msgtype.replace("/", "__") + ".msg"
        path = files("mpap_cli.logs") / "definitions" / name
        if not path.is_file():
            msg = f"{msgtype}: no definition of this message type is built in; choose another type"
            raise UsageError(msg)
        types = get_types_from_msg(path.read_text(encoding="utf-8"), msgtype)
        for _, fields in types.values():
            for _, description in fields:
                inner = _inner_name(description)
                if inner is not None:
                    self._learn(inner)
        self.store.register(types)

    def _maker(self, msgtype: str) -> Callable[[Message], object]:
        """Return the function that makes typed messages of mappings, built at first use."""
        if msgtype not in self._makers:
            self._learn(msgtype)
            self._makers[msgtype] = self._make_maker(msgtype)
        return self._makers[msgtype]

    def _make_maker(self, msgtype: str) -> Callable[[Message], object]:
        _, fields = self.store.fielddefs[msgtype]
        makers = [(name, self._field_maker(description)) for name, description in fields]
        names = {name for name, _ in fields}
        cls = self.store.types[msgtype]

        def make(message: Message) -> object:
            if not names.issuperset(message):
                unknown = ", ".join(sorted(set(message) - names))
                msg = f"{msgtype} has no field {unknown}; it has {', '.join(sorted(names))}"
                raise UsageError(msg)
            return cls(*(maker(message.get(name)) for name, maker in makers))

        return make

    def _field_maker(self, description: FieldDesc) -> Callable[[Any], Any]:
        """Return what turns the value of one field (None: left out) into what rosbags takes."""
        if description[0] == Nodetype.NAME:
            inner = self._maker(description[1])
            return lambda value: inner(value or {})
        if description[0] == Nodetype.BASE:
            zero = _zero(description[1][0])
            return lambda value: zero if value is None else value
        element, size = description[1]
        if element[0] == Nodetype.NAME:
            inner = self._maker(element[1])
            return lambda value: [inner(item) for item in value or ()]
        if element[1][0] in _NO_NUMPY:
            return lambda value: list(value or ())
        dtype = np.dtype(element[1][0].replace("char", "uint8").replace("byte", "uint8"))
        n_zeros = size if description[0] == Nodetype.ARRAY else 0
        zeros = np.zeros(n_zeros, dtype)
        return lambda value: zeros if value is None else np.asarray(value, dtype)


def _inner_name(description: FieldDesc) -> str | None:
    """Return the message type that a field holds, if it holds one."""
    if description[0] in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        description = description[1][0]
    return str(description[1]) if description[0] == Nodetype.NAME else None


def _zero(name: str) -> object:
    if name in _NO_NUMPY:
        return ""
    if name == "bool":
        return False
    return 0.0 if name.startswith("float") else 0


class JsonEncoder:
    """Writes messages as JSON text; types are JSON schemas among the built-in definitions.

    Examples
    --------
    >>> JsonEncoder().encode("Bumper", {"pressed": True})
    b'{"pressed":true}'
    """

    def encode(self, msgtype: str, message: Message) -> bytes:
        """Return the text of one message; arrays become lists of at most six decimals.

        Raises
        ------
        UsageError
            If a number is infinite or NaN, which JSON cannot hold.
        """
        try:
            text = json.dumps(message, default=_as_list, separators=(",", ":"), allow_nan=False)
        except ValueError as err:
            msg = f"{msgtype}: JSON cannot hold inf or NaN; choose another code for no return"
            raise UsageError(msg) from err
        return text.encode()

    def definition(self, msgtype: str) -> tuple[str, str]:
        """Return the JSON schema of a type, and no hash."""
        path = files("mpap_cli.logs") / "definitions" / f"{msgtype}.json"
        if not path.is_file():
            msg = f"{msgtype}: no JSON schema of this name is built in; choose another type"
            raise UsageError(msg)
        return path.read_text(encoding="utf-8"), ""


def _as_list(array: Any) -> list[float]:
    values: list[float] = np.round(np.asarray(array, np.float64), _JSON_DECIMALS).tolist()
    return values
