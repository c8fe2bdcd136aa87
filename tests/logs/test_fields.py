"""Scans out of raw payloads."""

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from mpap_cli.logs.fields import FieldError, scan_view
from mpap_cli.logs.raw import RawMessage, Topic
from mpap_cli.logs.writing.encoding import RosEncoder
from mpap_cli.observations import Float32Array, ScanGeometry
from tests import protobufs

LASER_SCAN = "sensor_msgs/msg/LaserScan"
ENCODERS = {"ros1": RosEncoder(1), "cdr": RosEncoder(2)}
LOG_NS = 77


def scan_fields(ranges: Any, **fields: Any) -> dict[str, Any]:
    """Return the fields of a scan of 0.5 degrees a beam."""
    stamp = {"sec": 1_518_607_201, "nanosec": 250_000_000}
    return {
        "header": {"stamp": stamp, "frame_id": "laser"},
        "angle_min": -math.pi / 2,
        "angle_max": math.pi / 2,
        "angle_increment": math.radians(0.5),
        "time_increment": 0.001,
        "scan_time": 0.2,
        "range_min": 0.02,
        "range_max": 5.0,
        "ranges": np.asarray(ranges, dtype=np.float32),
        "intensities": np.ones(3, dtype=np.float32),
        **fields,
    }


def raw_scan(encoding: str, fields: Mapping[str, Any]) -> RawMessage:
    """Return a scan as it lies in a log."""
    topic = Topic("/scan", LASER_SCAN, encoding, 1, "", "")
    return RawMessage(topic, LOG_NS, ENCODERS[encoding].encode(LASER_SCAN, fields))


def json_scan(**fields: Any) -> RawMessage:
    """Return a foxglove.LaserScan as JSON."""
    message = {
        "timestamp": {"sec": 3, "nsec": 5},
        "frame_id": "laser",
        "start_angle": -1.0,
        "end_angle": 1.0,
        "ranges": [1.0, 0.0, 2.5],
        **fields,
    }
    topic = Topic("/scan", "foxglove.LaserScan", "json", 1, "", "jsonschema")
    return RawMessage(topic, LOG_NS, json.dumps(message).encode())


@pytest.mark.parametrize("encoding", ["ros1", "cdr"])
@given(
    ranges=hnp.arrays(np.float32, st.integers(1, 40), elements=st.floats(width=32)),
    frame=st.text(max_size=12).filter(lambda text: "\0" not in text),
)
def test_scan_is_what_was_serialised(encoding: str, ranges: Float32Array, frame: str) -> None:
    """Any ranges and any frame name come back bit for bit."""
    header = {"stamp": {"sec": 5, "nanosec": 7}, "frame_id": frame}
    message = raw_scan(encoding, scan_fields(ranges, header=header))

    stamp_ns, found, geometry = scan_view(message, "header")

    assert stamp_ns == 5_000_000_007
    assert found.tobytes() == ranges.tobytes()
    assert (geometry.n_beams, geometry.frame_id) == (len(ranges), frame)


@pytest.mark.parametrize("encoding", ["ros1", "cdr"])
def test_geometry_is_that_of_the_message(encoding: str) -> None:
    """Angles and limits are taken as they stand, in float32."""
    _, _, geometry = scan_view(raw_scan(encoding, scan_fields([1.0, 2.0])))

    found = [geometry.angle_min, geometry.angle_increment, geometry.range_min, geometry.range_max]
    np.testing.assert_array_equal(
        found, np.array([-math.pi / 2, math.radians(0.5), 0.02, 5.0], np.float32)
    )
    assert (geometry.n_beams, geometry.frame_id) == (2, "laser")


def test_scans_of_one_geometry_share_the_object() -> None:
    """The geometry is built once, whatever the stamps and the scan time are."""
    first = scan_view(raw_scan("cdr", scan_fields([1.0, 2.0])))
    second = scan_view(raw_scan("cdr", scan_fields([3.0, 4.0], scan_time=0.3)))

    assert first[2] is second[2]


@pytest.mark.parametrize("encoding", ["ros1", "cdr"])
def test_stamp_is_log_time_unless_asked(encoding: str) -> None:
    """Log time is the default; the header's stamp is there on demand."""
    message = raw_scan(encoding, scan_fields([1.0]))

    assert scan_view(message)[0] == LOG_NS
    assert scan_view(message, "header")[0] == 1_518_607_201_250_000_000


def test_big_endian_cdr_is_read() -> None:
    """The byte order is the one that the encapsulation tells."""
    store = ENCODERS["cdr"].store
    little = raw_scan("cdr", scan_fields([1.0, 2.0, np.inf]))
    decoded = store.deserialize_cdr(little.payload, LASER_SCAN)
    payload = bytes(store.serialize_cdr(decoded, LASER_SCAN, little_endian=False))

    stamp_ns, ranges, geometry = scan_view(little._replace(payload=payload), "header")

    assert payload[:2] == b"\x00\x00"
    assert (stamp_ns, geometry) == (scan_view(little, "header")[0], scan_view(little)[2])
    assert ranges.dtype == np.dtype(">f4")
    assert ranges.tolist() == [1.0, 2.0, np.inf]


def test_ranges_are_a_view_into_the_payload() -> None:
    """Nothing is copied; the view is only for reading."""
    message = raw_scan("cdr", scan_fields([1.0, 2.0]))

    _, view, _ = scan_view(message)

    assert np.shares_memory(view, np.frombuffer(message.payload, np.uint8))
    assert not view.flags.writeable


@pytest.mark.parametrize("encoding", ["ros1", "cdr"])
def test_payload_cut_anywhere_before_the_last_range_is_a_field_error(encoding: str) -> None:
    """No cut leads to another error or to invented ranges."""
    message = raw_scan(encoding, scan_fields([1.0, 2.0], intensities=None))
    whole = len(message.payload) - 4  # the count of the intensities

    for length in range(whole):
        with pytest.raises(FieldError, match=r"cut short|shorter than|no plain CDR"):
            scan_view(message._replace(payload=message.payload[:length]))


@pytest.mark.parametrize("encoding", ["ros1", "cdr"])
def test_count_beyond_the_payload_is_a_field_error(encoding: str) -> None:
    """A count of four billion beams takes no memory."""
    payload = bytearray(raw_scan(encoding, scan_fields([1.0], intensities=None)).payload)
    payload[-12:-8] = b"\xff\xff\xff\xff"
    message = raw_scan(encoding, scan_fields([1.0]))._replace(payload=bytes(payload))

    with pytest.raises(FieldError, match="cut short"):
        scan_view(message)


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"ranges": np.zeros(0, np.float32)}, "without beams"),
        ({"angle_min": math.nan}, "angles are no numbers"),
        ({"angle_increment": math.inf}, "angles are no numbers"),
        ({"angle_increment": 0.0, "angle_max": -math.pi / 2}, "all one angle"),
    ],
)
def test_scan_that_cannot_be_placed_is_a_field_error(fields: dict[str, Any], text: str) -> None:
    """Beams need angles."""
    with pytest.raises(FieldError, match=text):
        scan_view(raw_scan("cdr", scan_fields([1.0, 2.0]) | fields))


def test_empty_increment_follows_from_the_ends() -> None:
    """Where a driver leaves the increment 0, first and last angle tell it."""
    fields = scan_fields([1.0, 1.0, 1.0], angle_increment=0.0)

    geometry = scan_view(raw_scan("cdr", fields))[2]

    assert geometry.angle_increment == pytest.approx(math.pi / 2)


def test_limits_that_are_no_numbers_count_as_empty() -> None:
    """A range_max of NaN becomes 0, so that geometries can be compared."""
    geometry = scan_view(raw_scan("cdr", scan_fields([1.0], range_max=math.nan)))[2]

    assert geometry.range_max == 0.0


@pytest.mark.parametrize("encoding", ["flatbuffer", ""])
def test_other_encodings_are_field_errors(encoding: str) -> None:
    """An encoding that is not read is named."""
    topic = Topic("/scan", LASER_SCAN, encoding, 1, "", "")

    with pytest.raises(FieldError, match=f"encoding {encoding or 'unknown'}"):
        scan_view(RawMessage(topic, 0, b""))


def test_protobuf_scan_is_read() -> None:
    """Fields that are left out have their defaults; farther than 32 bits tell is inf."""
    fields = {"start_angle": -1.0, "end_angle": 1.0, "ranges": [1.0, math.nan, 1e300]}
    payload = protobufs.payload("foxglove.LaserScan", 3_000_000_005, **fields)
    message = RawMessage(protobufs.topic("/scan", "foxglove.LaserScan"), LOG_NS, payload)

    stamp_ns, ranges, geometry = scan_view(message, "header")

    assert (stamp_ns, scan_view(message)[0]) == (3_000_000_005, LOG_NS)
    np.testing.assert_array_equal(ranges, np.array([1.0, np.nan, np.inf], np.float32))
    assert geometry == ScanGeometry(3, -1.0, 1.0, 0.0, 0.0, "")


@pytest.mark.parametrize(
    ("payload", "text"),
    [
        (b"\xff", "follow foxglove"),
        (protobufs.payload("foxglove.LaserScan", 1), "without beams"),
        (protobufs.payload("foxglove.LaserScan", ranges=[1.0, 2.0]), "all one angle"),
        (protobufs.payload("foxglove.LaserScan", 10**20, ranges=[1.0]), "follow foxglove"),
    ],
)
def test_broken_protobuf_scan_is_a_field_error(payload: bytes, text: str) -> None:
    """What is no protobuf, no scan, or of no clock is an error of that message."""
    topic = protobufs.topic("/scan", "foxglove.LaserScan")

    with pytest.raises(FieldError, match=text):
        scan_view(RawMessage(topic, LOG_NS, payload), "header")


def test_protobuf_scan_without_a_schema_is_a_field_error() -> None:
    """Numbers of fields alone say nothing."""
    payload = protobufs.payload("foxglove.LaserScan", 1, ranges=[1.0])
    topic = Topic("/scan", "foxglove.LaserScan", "protobuf", 1, "", "")

    with pytest.raises(FieldError, match="follow foxglove"):
        scan_view(RawMessage(topic, LOG_NS, payload))


def test_json_scan_is_read() -> None:
    """The increment follows from the end angles, null is a beam without return."""
    message = json_scan(ranges=[1.0, None, 2.5])

    stamp_ns, ranges, geometry = scan_view(message, "header")

    assert (stamp_ns, scan_view(message)[0]) == (3_000_000_005, LOG_NS)
    np.testing.assert_array_equal(ranges, np.array([1.0, np.nan, 2.5], np.float32))
    assert geometry == ScanGeometry(3, -1.0, 1.0, 0.0, 0.0, "laser")


@pytest.mark.parametrize(
    "fields",
    [
        {"ranges": None},
        {"ranges": [[1.0]]},
        {"ranges": ["x"]},
        {"timestamp": {}},
        {"timestamp": 5},
        {"timestamp": {"sec": 10**12, "nsec": 0}},
        {"start_angle": "west"},
        {"end_angle": None},
    ],
)
def test_json_of_another_shape_is_a_field_error(fields: dict[str, Any]) -> None:
    """Fields of the wrong type are errors of that message."""
    with pytest.raises(FieldError, match="follow foxglove"):
        scan_view(json_scan(**fields))


@pytest.mark.parametrize("payload", [b"", b"[]", b"{", b"\xff", b"null"])
def test_broken_json_is_a_field_error(payload: bytes) -> None:
    """What is no JSON object is an error of that message."""
    with pytest.raises(FieldError, match="follow foxglove"):
        scan_view(json_scan()._replace(payload=payload))
