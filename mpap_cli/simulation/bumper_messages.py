"""The same switches in the messages of several robots."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from mpap_cli.simulation.bumper import SwitchChange

_TICK_NS = 100_000_000
_TOUCH_NS = 50_000_000
_KOBUKI_SENSORS = {"left": 0, "center": 1, "right": 2}
_CREATE3_BACKUP_LIMIT, _CREATE3_BUMP = 0, 1

Fields = dict[str, Any]
Header = Callable[[int, str], Fields]


@dataclass(frozen=True, slots=True, kw_only=True)
class BumperType:
    """A kind of bumper message.

    ``kind`` is level (the whole state, ten times a second), edge (one message per change
    of one switch) or pulse (messages only while touching). ``fields`` makes a message of
    the header and of the closed switches, for an edge of the switch and its state.
    """

    ros1: str
    ros2: str
    topic: str
    kind: str
    fields: Callable[[Fields, Sequence[str], bool], Fields]


def _kobuki(_: Fields, switches: Sequence[str], pressed: bool) -> Fields:
    return {"bumper": _KOBUKI_SENSORS[switches[0]], "state": int(pressed)}


def _hazards(header: Fields, switches: Sequence[str], _: bool) -> Fields:
    # the real robot reports its backup limit all the time, which is no collision
    limit = {"header": {**header, "frame_id": "base_link"}, "type": _CREATE3_BACKUP_LIMIT}
    bumps = [
        {"header": {**header, "frame_id": f"bump_front_{switch}"}, "type": _CREATE3_BUMP}
        for switch in switches
    ]
    return {"header": header, "detections": [limit, *bumps]}


def _bool(_: Fields, switches: Sequence[str], __: bool) -> Fields:
    return {"data": bool(switches)}


def _four(switches: Sequence[str]) -> tuple[int, int, int, int]:
    """Return left front, left side, right front, right side of a Neato."""
    front = int("center" in switches)
    return front, int("left" in switches), front, int("right" in switches)


def _int8(_: Fields, switches: Sequence[str], __: bool) -> Fields:
    return {"data": _four(switches)}


def _neato(names: Sequence[str]) -> Callable[[Fields, Sequence[str], bool], Fields]:
    return lambda _, switches, __: dict(zip(names, _four(switches), strict=True))


def _gazebo(header: Fields, switches: Sequence[str], _: bool) -> Fields:
    # the ground is in contact all the time
    other = ["ground_plane::link::collision", *("obstacle::link::collision" for _ in switches)]
    own = ["mobile_base::base_link::wheel", *(f"mobile_base::bumper::{s}" for s in switches)]
    pairs = zip(own, other, strict=True)
    states = [{"collision1_name": a, "collision2_name": b, "depths": [0.001]} for a, b in pairs]
    return {"header": header, "states": states}


def _gz(header: Fields, switches: Sequence[str], _: bool) -> Fields:
    contacts = [
        {
            "collision1": {"name": f"mobile_base::bumper::{switch}"},
            "collision2": {"name": "obstacle::link::collision"},
            "depths": [0.001],
        }
        for switch in switches
    ]
    return {"header": header, "contacts": contacts}


def _pressed(header: Fields, switches: Sequence[str], _: bool) -> Fields:
    return {"timestamp": header["timestamp"], "pressed": bool(switches)}


_NEATO1 = _neato(("leftFront", "leftSide", "rightFront", "rightSide"))
_NEATO2 = _neato(("left_front", "left_side", "right_front", "right_side"))


def _level(topic: str, msgtype: str, fields: Any) -> BumperType:
    return BumperType(ros1=msgtype, ros2=msgtype, topic=topic, kind="level", fields=fields)


BUMPER_TYPES: dict[str, BumperType] = {
    "kobuki": BumperType(
        ros1="kobuki_msgs/msg/BumperEvent",
        ros2="kobuki_ros_interfaces/msg/BumperEvent",
        topic="/events/bumper",
        kind="edge",
        fields=_kobuki,
    ),
    "create3": _level(
        "/hazard_detection", "irobot_create_msgs/msg/HazardDetectionVector", _hazards
    ),
    "bool": _level("/bumper", "std_msgs/msg/Bool", _bool),
    "int8": _level("/bump", "std_msgs/msg/Int8MultiArray", _int8),
    "neato": _level("/bump", "neato2_interfaces/msg/Bump", _NEATO2),
    "neato-ros1": _level("/bump", "neato_node/msg/Bump", _NEATO1),
    "gazebo": _level("/bumper_contact", "gazebo_msgs/msg/ContactsState", _gazebo),
    "gz": BumperType(
        ros1="ros_gz_interfaces/msg/Contacts",
        ros2="ros_gz_interfaces/msg/Contacts",
        topic="/bumper_contact",
        kind="pulse",
        fields=_gz,
    ),
    "pressed": _level("/bump", "Bumper", _pressed),
}
"""Bumper messages by short name; ``pressed`` is the JSON message, the only one of its log."""


class BumperTopic:
    """The messages of a bumper topic, in time order.

    Parameters
    ----------
    kind : BumperType
        What the messages look like.
    start_ns : int
        Of the first message of a level topic.
    """

    def __init__(self, kind: BumperType, start_ns: int) -> None:
        self._type = kind
        self._next_ns = start_ns
        self._closed: set[str] = set()

    def messages(
        self, changes: Sequence[SwitchChange], until_ns: int, header: Header
    ) -> Iterator[tuple[int, Fields]]:
        """Yield stamp and fields of the messages before a moment.

        Parameters
        ----------
        changes : sequence of SwitchChange
            All changes since the last call that lie before ``until_ns``.
        until_ns : int
            The moment.
        header : callable
            Makes a header of a stamp and a frame.
        """
        step_ns = _TOUCH_NS if self._type.kind == "pulse" else _TICK_NS
        waiting = list(changes)
        while self._next_ns < until_ns:
            yield from self._apply(waiting, self._next_ns, header)
            if self._type.kind == "level" or (self._type.kind == "pulse" and self._closed):
                at = header(self._next_ns, "base_link")
                yield self._next_ns, self._type.fields(at, sorted(self._closed), True)
            self._next_ns += step_ns
        yield from self._apply(waiting, until_ns, header)

    def _apply(
        self, waiting: list[SwitchChange], until_ns: int, header: Header
    ) -> Iterator[tuple[int, Fields]]:
        """Take in the changes before a moment; on an edge topic each is a message."""
        while waiting and waiting[0].stamp_ns < until_ns:
            change = waiting.pop(0)
            if change.pressed:
                self._closed.add(change.sensor)
            else:
                self._closed.discard(change.sensor)
            if self._type.kind == "edge":
                at = header(change.stamp_ns, "base_link")
                yield change.stamp_ns, self._type.fields(at, [change.sensor], change.pressed)
