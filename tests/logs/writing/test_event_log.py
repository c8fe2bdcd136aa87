"""What a model says of a log, written as MCAP for Foxglove."""

import json
import math
import resource
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader

from mpap_cli.errors import OutputError, UsageError
from mpap_cli.logs.frames import read_frame
from mpap_cli.logs.reader import open_log
from mpap_cli.logs.writing.event_log import EVENTS_TOPIC, EventLogWriter, Value

START_NS = 1_577_836_800_000_000_001
IMAGES = "/camera/annotated"
DECISIONS = "/mpap/decision"


def jpeg(seed: int = 0) -> bytes:
    """Return a small image of noise, encoded."""
    pixels = np.random.default_rng(seed).integers(0, 256, (24, 32, 3), dtype=np.uint8)
    return bytes(cv2.imencode(".jpg", pixels)[1].tobytes())


def write_all(path: Path) -> None:
    """Write an image, values and two events, the longer event late."""
    with EventLogWriter(path) as log:
        log.image(IMAGES, START_NS, jpeg(), "camera")
        log.value(DECISIONS, START_NS, {"action": "stop", "p": 0.25, "distance": None})
        log.value(DECISIONS, START_NS + 5, {"action": "straight", "p": math.nan, "distance": 1})
        log.event(START_NS + 4, 0, {"what": "press"})
        log.event(START_NS + 2, 3_000_000_000, {"what": "novel", "cluster": "7"})


def read_all(path: Path) -> list[tuple[str, str, int, dict[str, Any]]]:
    """Return topic, schema, log time and fields of every message, as mcap reads them."""
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        return [
            (
                channel.topic,
                schema.name if schema else "",
                message.log_time,
                json.loads(message.data),
            )
            for schema, channel, message in reader.iter_messages()
        ]


@contextmanager
def small_disk(n_bytes: int) -> Iterator[None]:
    """Let no file of this process grow beyond so many bytes."""
    old = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (n_bytes, old[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)


def write_much(path: Path) -> None:
    """Write four megabytes of noise."""
    noise = np.random.default_rng(0).bytes(1 << 20)
    with EventLogWriter(path) as log:
        for index in range(4):
            log.image(IMAGES, START_NS + index, noise)


def write_then_fail(path: Path) -> None:
    """Write an event, then one that ends before it begins."""
    with EventLogWriter(path) as log:
        log.event(START_NS, 1, {})
        log.event(START_NS, -1, {})


def test_messages_bear_the_log_times_of_their_source(tmp_path: Path) -> None:
    """Topics, schemas and stamps come back in time order, though events were written late."""
    path = tmp_path / "predicted.mcap"

    write_all(path)

    found = [(topic, schema, stamp - START_NS) for topic, schema, stamp, _ in read_all(path)]
    assert found == [
        (IMAGES, "foxglove.CompressedImage", 0),
        (DECISIONS, "mpap.decision", 0),
        (EVENTS_TOPIC, "foxglove.Event", 2),
        (EVENTS_TOPIC, "foxglove.Event", 4),
        (DECISIONS, "mpap.decision", 5),
    ]


def test_file_is_json_with_schemas_in_zstd_chunks(tmp_path: Path) -> None:
    """The profile is empty, channels are JSON with a JSON schema, chunks are zstd."""
    path = tmp_path / "predicted.mcap"

    write_all(path)

    with path.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        assert reader.get_header().profile == ""
    assert summary is not None
    assert {channel.message_encoding for channel in summary.channels.values()} == {"json"}
    assert {schema.encoding for schema in summary.schemas.values()} == {"jsonschema"}
    assert {chunk.compression for chunk in summary.chunk_indexes} == {"zstd"}


def test_messages_hold_what_their_schemas_ask_for(tmp_path: Path) -> None:
    """Every required field is there, and no field that the schema does not name."""
    path = tmp_path / "predicted.mcap"

    write_all(path)

    with path.open("rb") as file:
        found = list(make_reader(file).iter_messages())
    for schema, _, message in found:
        assert schema is not None
        described, fields = json.loads(schema.data), json.loads(message.data)
        assert described["title"] == schema.name
        assert described["type"] == "object"
        assert set(described.get("required", ())) <= set(fields) <= set(described["properties"])


def test_event_lasts_from_its_start_to_its_end(tmp_path: Path) -> None:
    """Start and end are seconds and nanoseconds, metadata are keys and values in order."""
    path = tmp_path / "predicted.mcap"

    write_all(path)

    fields = next(fields for topic, _, _, fields in read_all(path) if topic == EVENTS_TOPIC)
    assert fields == {
        "start_time": {"sec": 1_577_836_800, "nsec": 3},
        "end_time": {"sec": 1_577_836_803, "nsec": 3},
        "metadata": [{"key": "what", "value": "novel"}, {"key": "cluster", "value": "7"}],
    }


def test_what_json_cannot_hold_is_left_out(tmp_path: Path) -> None:
    """None and NaN are no field of the message; the schema names them as numbers."""
    path = tmp_path / "predicted.mcap"

    write_all(path)

    values = [fields for topic, _, _, fields in read_all(path) if topic == DECISIONS]
    assert values == [{"action": "stop", "p": 0.25}, {"action": "straight", "distance": 1.0}]
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    schema = next(s for s in summary.schemas.values() if s.name == "mpap.decision")
    kinds = {name: field["type"] for name, field in json.loads(schema.data)["properties"].items()}
    assert kinds == {"action": "string", "p": "number", "distance": "number"}


def test_our_own_reader_finds_the_images(tmp_path: Path) -> None:
    """An annotated image is an image topic like any other, byte by byte."""
    path = tmp_path / "predicted.mcap"

    write_all(path)

    with open_log(path) as log:
        frames = [read_frame(log, message) for message in log.messages([IMAGES])]
        assert {topic.name for topic in log.topics} == {IMAGES, DECISIONS, EVENTS_TOPIC}
        assert log.warnings == []
        assert log.damage == []
    assert [(one.stamp_ns, one.encoding) for one in frames] == [(START_NS, "compressed")]
    assert frames[0].payload == jpeg()


def test_same_calls_same_bytes(tmp_path: Path) -> None:
    """The file holds no date and no name of its own."""
    write_all(tmp_path / "a.mcap")
    write_all(tmp_path / "b.mcap")

    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()


@given(
    numbers=st.lists(st.floats(allow_nan=False, allow_infinity=False), max_size=4),
    texts=st.lists(st.text(), max_size=4),
)
@settings(max_examples=25, deadline=None)
def test_numbers_and_texts_come_back_exactly(numbers: list[float], texts: list[str]) -> None:
    """Whatever number or text is written, it is read."""
    fields: dict[str, Value] = {f"n{index}": one for index, one in enumerate(numbers)}
    fields |= {f"t{index}": one for index, one in enumerate(texts)}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "predicted.mcap"

        with EventLogWriter(path) as log:
            log.value("/value", START_NS, fields)

        found = read_all(path)
    assert found == [("/value", "value", START_NS, fields)]


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"p": "high"}, r"/mpap/p: found p \(string\), expected .*first message: p \(number\)"),
        ({"q": 0.5}, r"/mpap/p: found q \(number\)"),
    ],
)
def test_fields_stay_as_in_the_first_message(
    tmp_path: Path, fields: dict[str, Value], message: str
) -> None:
    """A topic has one schema: other fields or other kinds are refused."""
    with EventLogWriter(tmp_path / "predicted.mcap") as log:
        log.value("/mpap/p", START_NS, {"p": 0.5})

        with pytest.raises(UsageError, match=message):
            log.value("/mpap/p", START_NS, fields)


def test_nothing_is_left_after_an_error(tmp_path: Path) -> None:
    """A file that could not be finished leaves nothing; the event's fault is named."""
    with pytest.raises(UsageError, match="duration of an event: found -1 ns"):
        write_then_fail(tmp_path / "predicted.mcap")

    assert list(tmp_path.iterdir()) == []


def test_existing_file_is_not_touched(tmp_path: Path) -> None:
    """A path that exists is refused and stays as it is."""
    path = tmp_path / "predicted.mcap"
    path.write_text("mine")

    with pytest.raises(OutputError, match=r"predicted\.mcap: exists already"):
        write_all(path)

    assert path.read_text() == "mine"


def test_full_disk_is_one_line(tmp_path: Path) -> None:
    """A disk that fills while writing is an error of the output, and nothing is left."""
    path = tmp_path / "predicted.mcap"

    with small_disk(1 << 20), pytest.raises(OutputError, match=r"mcap: cannot be written \(file"):
        write_much(path)

    assert list(tmp_path.iterdir()) == []


def test_disk_that_fills_at_the_end_is_one_line(tmp_path: Path) -> None:
    """The last chunk is written when the file is closed; that fails in one line too."""
    path = tmp_path / "predicted.mcap"

    with small_disk(100), pytest.raises(OutputError, match=r"mcap: cannot be written \(file"):
        write_all(path)

    assert list(tmp_path.iterdir()) == []
