"""Streams over remote files: what they give, and how much they fetch for it."""

import io
import random
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs.remote.range_stream import (
    KEPT_BYTES,
    LEAST_BYTES,
    MOST_BYTES,
    Blocks,
    RangeStream,
)

MIB = 1 << 20
CONTENT = random.Random(7).randbytes(3 * MIB)  # noqa: S311  # any bytes

Fetched = list[tuple[int, int]]


def stream_over(
    content: bytes | None, size: int, blocks: Blocks | None = None
) -> tuple[RangeStream, Fetched]:
    """Return a stream, and the list of ranges that it fetches; without content of zeros."""
    fetched: Fetched = []

    def fetch(begin: int, end: int) -> bytes:
        fetched.append((begin, end))
        return bytes(end - begin) if content is None else content[begin:end]

    return RangeStream(size, fetch, Blocks() if blocks is None else blocks), fetched


def n_bytes(fetched: Fetched) -> int:
    """Return how much was fetched."""
    return sum(end - begin for begin, end in fetched)


@given(st.lists(st.tuples(st.integers(0, 3 * MIB + 99), st.integers(0, MIB)), max_size=30))
def test_gives_what_the_file_holds_wherever_it_is_read(places: list[tuple[int, int]]) -> None:
    """Any sequence of reads gives what a local file gives."""
    stream, _ = stream_over(CONTENT, len(CONTENT))
    local = io.BytesIO(CONTENT)

    for place, size in places:
        stream.seek(place)
        local.seek(place)
        assert stream.read(size) == local.read(size)
        assert stream.tell() == min(local.tell(), max(place, len(CONTENT)))


@pytest.mark.parametrize(
    ("seek", "position"),
    [
        (lambda stream: stream.seek(-10, io.SEEK_END), 3 * MIB - 10),
        (lambda stream: stream.seek(5) + stream.seek(7, io.SEEK_CUR) - 5, 12),
        (lambda stream: stream.seek(-5), 0),
    ],
)
def test_seeks_from_everywhere(seek: Callable[[RangeStream], int], position: int) -> None:
    """Positions count from the beginning, from here or from the end."""
    stream, fetched = stream_over(CONTENT, len(CONTENT))

    found = seek(stream)

    assert found == stream.tell() == position
    assert not fetched


def test_reads_on_in_few_requests() -> None:
    """A file that is read through is fetched once, in blocks that grow to the most."""
    stream, fetched = stream_over(None, 64 * MIB)

    while stream.read(1000):
        pass

    assert n_bytes(fetched) == 64 * MIB
    assert len(fetched) < 30
    assert max(end - begin for begin, end in fetched) == MOST_BYTES


def test_fetches_little_more_than_far_chunks() -> None:
    """Of chunks of a like size far apart, each behind the first takes one request."""
    stream, fetched = stream_over(None, 1 << 40)
    size = 300_000

    for number in range(20):
        stream.seek(number << 30)
        stream.read(57)
        stream.read(size)

    assert len(fetched) == 21
    assert n_bytes(fetched) < 1.2 * 20 * size


def test_fetches_a_footer_with_what_stands_before_it() -> None:
    """The end of a file, and the little summary before it, take one request."""
    stream, fetched = stream_over(CONTENT, len(CONTENT))

    stream.seek(-37, io.SEEK_END)
    tail = stream.read(37)
    stream.seek(-4000, io.SEEK_END)
    summary = stream.read(3963)

    assert summary + tail == CONTENT[-4000:]
    assert fetched == [(len(CONTENT) - LEAST_BYTES, len(CONTENT))]


def test_streams_of_one_file_share_what_was_fetched() -> None:
    """What a stream has fetched lately, another one need not."""
    blocks = Blocks()
    first, _ = stream_over(CONTENT, len(CONTENT), blocks)
    first.read(2 * MIB)
    second, fetched = stream_over(CONTENT, len(CONTENT), blocks)

    found = second.read()

    assert found == CONTENT
    assert n_bytes(fetched) == len(CONTENT) - 2 * MIB


def test_keeps_so_much_and_no_more() -> None:
    """The oldest blocks go where more was fetched than is kept."""
    blocks = Blocks()
    stream, _ = stream_over(None, 2 * KEPT_BYTES, blocks)

    while stream.read(MIB):
        pass

    assert len(blocks.at(2 * KEPT_BYTES - 1)) == 1
    assert len(blocks.at(KEPT_BYTES + MOST_BYTES)) > 0
    assert len(blocks.at(KEPT_BYTES - MOST_BYTES)) == 0
