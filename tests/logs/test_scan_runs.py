"""Scans read run by run are those read one by one."""

import json
from collections import Counter
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs.fields import FieldError, scan_view
from mpap_cli.logs.files.runs import group_messages
from mpap_cli.logs.raw import RawMessage, RawRun, Topic
from mpap_cli.logs.scan_runs import Payloads, read_scans
from mpap_cli.logs.writing.encoding import RosEncoder
from mpap_cli.observations import NS_PER_S, Float32Array
from tests import protobufs

LASER_SCAN = "sensor_msgs/msg/LaserScan"
ENCODERS = {"ros1": RosEncoder(1), "cdr": RosEncoder(2)}
Scans = list[tuple[int, list[float], Any]]


def floats(values: Sequence[float]) -> Float32Array:
    """Return ranges."""
    return np.array(values, dtype=np.float32)


def encode(encoding: str, fields: dict[str, Any]) -> bytes:
    """Return a scan in an encoding; ``big`` asks for big-endian CDR."""
    if encoding == "json":
        stamp = {"sec": fields["sec"], "nsec": 5}
        scan = {"timestamp": stamp, "start_angle": -1.0, "end_angle": 1.0}
        return json.dumps({**scan, "ranges": fields["ranges"].tolist()}).encode()
    if encoding == "protobuf":
        scan = {"start_angle": -1.0, "end_angle": 1.0, "ranges": fields["ranges"].tolist()}
        return protobufs.payload("foxglove.LaserScan", fields["sec"] * NS_PER_S, **scan)
    header = {"stamp": {"sec": fields["sec"], "nanosec": 9}, "frame_id": fields["frame"]}
    names = ("angle_min", "angle_increment", "range_max", "scan_time", "ranges", "intensities")
    encoder = ENCODERS[encoding]
    payload = encoder.encode(LASER_SCAN, {"header": header, **{n: fields[n] for n in names}})
    if fields["big"] and encoding == "cdr":
        decoded = encoder.store.deserialize_cdr(payload, LASER_SCAN)
        payload = bytes(encoder.store.serialize_cdr(decoded, LASER_SCAN, little_endian=False))
    return payload


numbers = st.floats(0, 9, width=32)
scan_fields = st.fixed_dictionaries(
    {
        "sec": st.integers(0, 2**31 - 1),
        "frame": st.sampled_from(["laser", "scan"]),
        "angle_min": st.sampled_from([0.0, -0.0, -1.5, np.nan]),
        "angle_increment": st.sampled_from([0.1, 0.25]),
        "range_max": st.sampled_from([5.0, np.nan]),
        "scan_time": numbers,
        "ranges": st.sampled_from([0, 3, 4]).flatmap(
            lambda n: st.lists(numbers, min_size=n, max_size=n).map(floats)
        ),
        "intensities": st.sampled_from([[], [1.0]]),
        "big": st.just(value=False) | st.booleans(),
    }
)
flaws = st.sampled_from(["", "", "", "cut", "head", "flip", "padding"])


def spoil(payload: bytes, flaw: str) -> bytes:
    """Break a payload, or change what does not matter."""
    if flaw == "cut":
        return payload[:70]
    if flaw == "head":
        return payload[:9]
    if flaw == "flip":
        return b"\xff\xff" + payload[2:]
    return payload[:2] + b"\x05" + payload[3:] if flaw == "padding" else payload


def run_of(encoding: str, payloads: list[bytes]) -> RawRun:
    """Put payloads behind one another, as a log has them."""
    topic = Topic("/scan", LASER_SCAN, encoding, len(payloads), "", "")
    if encoding == "protobuf":
        topic = protobufs.topic("/scan", "foxglove.LaserScan", len(payloads))
    messages = (RawMessage(topic, 10 * n, payload) for n, payload in enumerate(payloads))
    ((run,),) = (group.runs for group in group_messages(messages))
    return run


def one_by_one(run: RawRun, time_source: Literal["log", "header"]) -> tuple[Scans, Counter[str]]:
    """Read each scan by itself."""
    scans: Scans = []
    skipped: Counter[str] = Counter()
    for number, stamp_ns in enumerate(run.stamps_ns.tolist()):
        message = RawMessage(run.topic, stamp_ns, run.payload(number))
        try:
            stamp, ranges, geometry = scan_view(message, time_source)
        except FieldError as err:
            skipped[str(err)] += 1
        else:
            scans.append((stamp, ranges.tolist(), geometry))
    return scans, skipped


@pytest.mark.parametrize("time_source", ["log", "header"])
@pytest.mark.parametrize("encoding", ["cdr", "ros1", "json", "protobuf", "cbor"])
@given(scans=st.lists(st.tuples(scan_fields, flaws), min_size=1, max_size=20))
def test_runs_hold_what_single_messages_do(
    encoding: str, time_source: Literal["log", "header"], scans: list[tuple[dict[str, Any], str]]
) -> None:
    """Whatever changes between scans, wherever they are broken."""
    form = "cdr" if encoding == "cbor" else encoding
    run = run_of(encoding, [spoil(encode(form, fields), flaw) for fields, flaw in scans])

    pieces, skipped = read_scans(run, time_source)

    found = [
        (int(stamp_ns), ranges.tolist(), piece.geometry)
        for piece in pieces
        for stamp_ns, ranges in zip(piece.stamps_ns, piece.ranges, strict=True)
    ]
    assert (found, skipped) == one_by_one(run, time_source)
    for piece in pieces:
        assert piece.ranges.dtype == np.float32
        assert piece.ranges.flags.writeable
        assert piece.ranges.flags.c_contiguous
        if time_source == "log":
            assert piece.recorded_ns.tolist() == piece.stamps_ns.tolist()


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_scans_that_never_repeat(encoding: str) -> None:
    """Each with an angle of its own is a piece of its own; after some, none are compared."""
    payloads = [
        encode(
            encoding,
            {
                "sec": number, "frame": "laser", "angle_min": 0.1 * number, "big": False,
                "angle_increment": 0.1, "range_max": 5.0, "scan_time": 0.1,
                "ranges": floats([number, 1]), "intensities": [],
            },
        )
        for number in range(30)
    ]  # fmt: skip
    run = run_of(encoding, payloads)

    pieces, _ = read_scans(run)

    assert len(pieces) == 30
    assert [int(piece.ranges[0, 0]) for piece in pieces] == list(range(30))


def wide_scans(n_before: int) -> RawRun:
    """Return ten scans of 500 beams, in memory that holds something else before them."""
    fields = {
        "sec": 1, "frame": "laser", "angle_min": 0.0, "angle_increment": 0.01, "range_max": 5.0,
        "scan_time": 0.1, "intensities": [], "big": False,
    }  # fmt: skip
    run = run_of("cdr", [encode("cdr", {**fields, "ranges": floats([n] * 500)}) for n in range(10)])
    records = bytes(n_before) + run.records
    return RawRun(run.topic, run.stamps_ns, records, run.starts + n_before, run.sizes)


@pytest.mark.parametrize(("n_before", "waits"), [(0, True), (100_000, False)])
def test_ranges_wait_in_memory_that_they_fill(n_before: int, waits: bool) -> None:
    """Wherever they lie, some of them and all of them are the same; little is copied at once."""
    (piece,), _ = read_scans(wide_scans(n_before))

    some = piece.rows(slice(3, 7))
    rows = np.zeros((4, 500), np.float32)
    some.write(rows)

    assert isinstance(piece.held, Payloads) == waits
    assert piece.ranges[:, 499].tolist() == list(range(10))
    np.testing.assert_array_equal(rows, piece.ranges[3:7])
    np.testing.assert_array_equal(some.ranges, rows)
