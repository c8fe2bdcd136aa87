"""Poses read run by run are those read one by one."""

import math
from collections import Counter
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs.files.runs import group_messages
from mpap_cli.logs.odometry import ODOMETRY_TYPE, PosePiece, read_poses
from mpap_cli.logs.raw import RawMessage, RawRun, Topic
from mpap_cli.logs.writing.encoding import RosEncoder
from mpap_cli.observations import NS_PER_S

ENCODERS = {"ros1": RosEncoder(1), "cdr": RosEncoder(2)}
NO_POSE = "a pose that is not finite or has no direction"

lengths = st.floats(-9, 9)
turns = st.integers(-2, 2).map(float)
poses = st.fixed_dictionaries(
    {
        "frame_id": st.sampled_from(["odom", "odom", "world", ""]),
        "child_frame_id": st.sampled_from(["base_link", "base", ""]),
        "sec": st.integers(0, 2**31 - 1),
        "position": st.tuples(lengths | st.just(math.nan), lengths, lengths),
        "rotation": st.tuples(turns, turns, turns, turns | st.just(math.inf)),
        "big": st.just(value=False) | st.booleans(),
        "flaw": st.sampled_from(["", "", "", "cut", "head", "kind"]),
    }
)


def message(x: float, y: float, rotation: tuple[float, ...], **others: Any) -> dict[str, Any]:
    """Return the fields of an odometry message."""
    names = dict(zip("xyzw", rotation, strict=True))
    pose = {"position": {"x": x, "y": y, "z": others.get("z", 0.0)}, "orientation": names}
    header = {"stamp": {"sec": others.get("sec", 0), "nanosec": 9}}
    header["frame_id"] = others.get("frame_id", "odom")
    child = others.get("child_frame_id", "base_link")
    return {"header": header, "child_frame_id": child, "pose": {"pose": pose}}


def encode(encoding: str, fields: dict[str, Any]) -> bytes:
    """Return a message of drawn fields, perhaps broken."""
    x, y, z = fields["position"]
    wanted = {name: fields[name] for name in ("frame_id", "child_frame_id", "sec")}
    encoder = ENCODERS[encoding]
    payload = encoder.encode(ODOMETRY_TYPE, message(x, y, fields["rotation"], z=z, **wanted))
    if fields["big"] and encoding == "cdr":
        decoded = encoder.store.deserialize_cdr(payload, ODOMETRY_TYPE)
        payload = bytes(encoder.store.serialize_cdr(decoded, ODOMETRY_TYPE, little_endian=False))
    flaw = fields["flaw"]
    if flaw == "kind":
        return b"\xff\xff" + payload[2:]
    return payload[: {"cut": 70, "head": 9}.get(flaw, len(payload))]


def run_of(encoding: str, payloads: list[bytes]) -> RawRun:
    """Put payloads behind one another, as a log has them."""
    topic = Topic("/odom", ODOMETRY_TYPE, encoding, len(payloads), "", "")
    messages = (RawMessage(topic, 10 * n, payload) for n, payload in enumerate(payloads))
    ((run,),) = (group.runs for group in group_messages(messages))
    return run


def one_by_one(
    encoding: str, drawn: list[dict[str, Any]]
) -> tuple[list[int], list[list[float]], Counter[str]]:
    """Work out numbers and poses of each message, and what is wrong with the rest."""
    kept, found = [], []
    skipped: Counter[str] = Counter()
    for number, fields in enumerate(drawn):
        if fields["flaw"] and (fields["flaw"] != "kind" or encoding == "cdr"):
            no_cdr = fields["flaw"] == "kind"
            skipped["a pose that is no plain CDR" if no_cdr else "a pose cut short"] += 1
            continue
        (x, y, _), (i, j, k, w) = fields["position"], fields["rotation"]
        east, north = w * w + i * i - j * j - k * k, 2 * (i * j + w * k)
        if math.isnan(x) or math.isinf(w) or east == north == 0:
            skipped[NO_POSE] += 1
            continue
        kept.append(number)
        found.append([x, y, math.atan2(north, east)])
    return kept, found, skipped


@pytest.mark.parametrize("time_source", ["log", "header"])
@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
@given(drawn=st.lists(poses, min_size=1, max_size=15))
def test_runs_hold_what_single_messages_do(
    encoding: str, time_source: Literal["log", "header"], drawn: list[dict[str, Any]]
) -> None:
    """Whatever changes between messages, wherever they are broken."""
    run = run_of(encoding, [encode(encoding, fields) for fields in drawn])

    piece, skipped = read_poses(run, time_source)

    kept, expected, left_out = one_by_one(encoding, drawn)
    by_header = [drawn[number]["sec"] * NS_PER_S + 9 for number in kept]
    recorded = [10 * number for number in kept]
    assert piece.recorded_ns.tolist() == recorded
    assert piece.stamps_ns.tolist() == (recorded if time_source == "log" else by_header)
    assert skipped == left_out
    np.testing.assert_allclose(piece.poses, np.reshape(expected, (-1, 3)), atol=1e-12)


@pytest.mark.parametrize("heading", [-3.0, -math.pi / 2, 0.0, 1e-9, 1.0, math.pi])
@pytest.mark.parametrize("length", [1.0, 0.5, 1e-3])
def test_heading_is_that_of_a_turn_about_the_vertical(heading: float, length: float) -> None:
    """The length of the quaternion does not matter."""
    rotation = (0.0, 0.0, length * math.sin(heading / 2), length * math.cos(heading / 2))
    payload = ENCODERS["cdr"].encode(ODOMETRY_TYPE, message(1.5, -2.5, rotation))

    piece, _ = read_poses(run_of("cdr", [payload]))

    assert piece.poses[0].tolist() == pytest.approx([1.5, -2.5, heading])
    assert piece.poses.shape == (1, 3)
    assert piece.poses.dtype == np.float64


@pytest.mark.parametrize(
    ("place", "rotation"),
    [
        ((math.nan, 0.0), (0.0, 0.0, 0.0, 1.0)),
        ((0.0, -math.inf), (0.0, 0.0, 0.0, 1.0)),
        ((0.0, 0.0), (0.0, 0.0, 0.0, 0.0)),
        ((0.0, 0.0), (0.0, 0.0, math.nan, 1.0)),
        ((0.0, 0.0), (math.inf, 0.0, 0.0, math.inf)),
        ((0.0, 0.0), (0.0, 0.0, 1e200, 1e200)),
        ((0.0, 0.0), (0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5))),
    ],
)
def test_pose_that_is_none_is_left_out_and_counted(
    place: tuple[float, float], rotation: tuple[float, ...]
) -> None:
    """Not finite, a quaternion that drivers leave empty, or a robot that looks up."""
    payloads = [
        ENCODERS["ros1"].encode(ODOMETRY_TYPE, fields)
        for fields in (message(*place, rotation), message(1.0, 2.0, (0.0, 0.0, 0.0, 1.0)))
    ]

    piece, skipped = read_poses(run_of("ros1", payloads))

    assert piece.poses.tolist() == [[1.0, 2.0, 0.0]]
    assert (piece.recorded_ns.tolist(), skipped) == ([10], {NO_POSE: 1})


def test_run_without_a_pose_is_an_empty_piece() -> None:
    """All are cut short, or in an encoding that is not read."""
    cut, in_other_encoding = (read_poses(run_of(kind, [b"", b"\0"])) for kind in ("ros1", "json"))

    for piece, _ in (cut, in_other_encoding):
        assert isinstance(piece, PosePiece)
        assert (piece.poses.shape, piece.stamps_ns.size, piece.recorded_ns.size) == ((0, 3), 0, 0)
    assert cut[1] == {"a pose cut short": 2}
    assert in_other_encoding[1] == {"a pose in encoding json": 2}
