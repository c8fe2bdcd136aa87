"""Walks over records, and changes of payloads, against plain loops in Python."""

import struct
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs.files import _kernels as kernels
from mpap_cli.logs.files.chunked.chunks import BrokenRecordError
from mpap_cli.logs.files.ros1_bags.bag_records import opcode_of, record_at
from mpap_cli.observations import IntArray

Found = tuple[list[tuple[int, int, int, int]], bool]
Walk = Callable[[bytes, Sequence[int]], Found]
Compiled = Callable[[bytes, IntArray], tuple[IntArray, int, int]]
WANTED = (3, 0, 70_000)

stamps = st.integers(0, 2**64 - 1) | st.integers(0, 99)
channels = st.sampled_from([0, 1, 3, 500])
payloads = st.binary(max_size=40)


def mcap_record(opcode: int, channel: int, stamp_ns: int, payload: bytes) -> bytes:
    """Return a record of an MCAP file; not every one is a message."""
    content = struct.pack("<HIQQ", channel, 7, stamp_ns, 9) + payload
    return struct.pack("<BQ", opcode, len(content)) + content


def bag_record(names: Sequence[bytes], opcode: int, stamp_ns: int, payload: bytes) -> bytes:
    """Return a record of a bag with its header fields in any order."""
    values = {
        b"op": bytes([opcode]),
        b"conn": struct.pack("<I", opcode % 4),
        b"time": struct.pack("<Q", stamp_ns),
        b"ti": b"=",
        b"long": b"\x03\0\0\0more",
    }
    fields = [name + b"=" + values[name] for name in names]
    header = b"".join(struct.pack("<I", len(field)) + field for field in fields)
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(payload)) + payload


mcap_chunks = st.lists(
    st.builds(mcap_record, st.sampled_from([3, 5, 5, 5]), channels, stamps, payloads)
    | st.builds(lambda opcode: struct.pack("<BQ", opcode, 0), st.integers(0, 255))
).map(b"".join)
bag_chunks = st.lists(
    st.builds(
        bag_record,
        st.permutations([b"op", b"conn", b"time", b"ti", b"long"])
        | st.lists(st.sampled_from([b"op", b"conn", b"time"])),
        st.sampled_from([2, 2, 2, 7]),
        stamps,
        payloads,
    )
).map(b"".join)


@st.composite
def broken(draw: st.DrawFn, chunks: st.SearchStrategy[bytes]) -> bytes:
    """Cut a chunk, or overwrite some of its bytes."""
    records = bytearray(draw(chunks))
    if records and draw(st.booleans()):
        del records[draw(st.integers(0, len(records))) :]
    for _ in range(draw(st.integers(0, 3)) if records else 0):
        place = draw(st.integers(0, len(records) - 1))
        text = draw(st.binary(min_size=1, max_size=8) | st.just(b"\xff" * 8))
        records[place : place + len(text)] = text
    return bytes(records)


def walk_mcap(records: bytes, wanted: Sequence[int]) -> Found:
    """Find messages record by record."""
    found: list[tuple[int, int, int, int]] = []
    position = 0
    while position < len(records):
        begin = position + 9
        if begin > len(records):
            return found, False
        opcode, size = struct.unpack_from("<BQ", records, position)
        position = begin + size
        if position > len(records) or (opcode == 5 and size < 22) or opcode not in {3, 4, 5}:
            return found, False
        if opcode == 5:
            channel, stamp_ns = struct.unpack_from("<H4xQ", records, begin)
            if channel in wanted:
                stamp_ns = min(stamp_ns, 2**63 - 1)
                found.append((wanted.index(channel), stamp_ns, begin + 22, size - 22))
    return found, True


def walk_bag(records: bytes, wanted: Sequence[int]) -> Found:
    """Find messages record by record."""
    found: list[tuple[int, int, int, int]] = []
    position = 0
    while position < len(records):
        try:
            fields, begin, end = record_at(records, position)
        except BrokenRecordError:
            return found, False
        position = end
        if opcode_of(fields) == 2:
            connection, time = fields.get(b"conn", b"")[:4], fields.get(b"time", b"")
            if len(connection) < 4:
                return found, False
            number = int.from_bytes(connection, "little")
            if number in wanted:
                if len(time) != 8:
                    return found, False
                seconds, nanoseconds = struct.unpack("<II", time)
                stamp_ns = seconds * 10**9 + nanoseconds
                found.append((wanted.index(number), stamp_ns, begin, end - begin))
    return found, True


WALKS: Mapping[str, tuple[Compiled, Walk]] = {
    "mcap": (kernels.walk_mcap, walk_mcap),
    "bag": (kernels.walk_bag, walk_bag),
}


def check_walk(kind: str, records: bytes) -> None:
    """Compare a walk with the plain one."""
    compiled, plain = WALKS[kind]

    found, stop, _ = compiled(records, np.array(WANTED))

    columns = [tuple(column) for column in found.T.tolist()]
    assert (columns, stop == len(records)) == plain(records, WANTED)


@given(records=mcap_chunks | broken(mcap_chunks) | st.binary())
def test_mcap_walk_is_the_plain_one(records: bytes) -> None:
    """Whole, cut and changed chunks give the same messages, and the same verdict."""
    check_walk("mcap", records)


@given(records=bag_chunks | broken(bag_chunks) | st.binary())
def test_bag_walk_is_the_plain_one(records: bytes) -> None:
    """Whole, cut and changed chunks give the same messages, and the same verdict."""
    check_walk("bag", records)


@pytest.mark.parametrize("place", range(0, 110, 3))
@pytest.mark.parametrize("size", [0, 21, 22, 2**31, 2**32 - 1, 2**63 - 1, 2**63, 2**64 - 1])
@pytest.mark.parametrize("kind", WALKS)
def test_any_length_is_believed_only_within_the_bytes(kind: str, size: int, place: int) -> None:
    """A length that is wrong, wherever it stands, leads nowhere outside."""
    records = {
        "mcap": mcap_record(5, 3, 8, b"payload") * 3,
        "bag": bag_record([b"op", b"conn", b"time"], 2, 8, b"payload") * 3,
    }[kind]
    changed = records[:place] + struct.pack("<Q", size) + records[place + 8 :]

    check_walk(kind, changed[: len(records)])


def test_more_messages_than_expected() -> None:
    """A chunk of very many messages is walked twice."""
    mcap = mcap_record(5, 3, 8, b"") * 5000
    bag = bag_record([b"op", b"conn", b"time"], 3, 8, b"") + bag_record(
        [b"op", b"conn", b"time"], 2, 8, b""
    )
    one = np.array([2])

    found, stop, last = kernels.walk_mcap(mcap, np.array([3]))
    of_bag, _, _ = kernels.walk_bag(bag * 5000, one)

    assert (found.shape, stop) == ((4, 5000), len(mcap))
    assert last == len(mcap) * 4999 // 5000
    assert of_bag.shape == (4, 5000)


@pytest.mark.parametrize("kind", WALKS)
def test_walks_as_python(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The loops do the same uncompiled."""
    for name in ("_number", "_u32", "_place_in", "_read_bag_header", "_walk_mcap", "_walk_bag"):
        monkeypatch.setattr(kernels, name, getattr(kernels, name).py_func)
    records = {
        "mcap": mcap_record(5, 3, 8, b"payload") * 2 + mcap_record(4, 3, 8, b""),
        "bag": bag_record([b"time", b"op", b"ti", b"conn"], 2, 8, b"payload") * 2,
    }[kind]

    for size in (0, 3, 9, 15, 33, len(records) - 1, len(records)):
        check_walk(kind, records[:size])
    check_walk(kind, mcap_record(5, 3, 8, b"payload") + struct.pack("<BQ", 5, 0) + bytes(9))
    check_walk(kind, bag_record([b"op"], 2, 8, b"") + bag_record([b"time"], 2, 8, b""))
    check_walk(kind, bag_record([b"op", b"conn"], 2, 8, b""))
    check_walk(kind, b"\x02\0\0\0" + bytes(20))
    check_walk(kind, b"\x05\0\0\0\x09\0\0\0" + bytes(20))
    check_walk(kind, b"\x05\0\0\0\x01\0\0\0z" + bytes(20))


@pytest.mark.parametrize("compiled", [True, False])
@given(texts=st.lists(st.binary(min_size=4, max_size=7), min_size=1), skip=st.integers(0, 4))
def test_comparisons_are_those_of_bytes(compiled: bool, texts: list[bytes], skip: int) -> None:
    """Payloads are compared with that before."""
    records = b"".join(texts)
    sizes = np.array([len(text) for text in texts])
    starts = np.cumsum(sizes) - sizes
    with pytest.MonkeyPatch.context() as patch:
        if not compiled:
            patch.setattr(kernels, "_find_changes", kernels._find_changes.py_func)

        changes = kernels.find_changes(records, starts, sizes, skip)

    assert changes.tolist() == [True] + [
        len(one) != len(other) or one[skip:] != other[skip:] for one, other in pairwise(texts)
    ]
