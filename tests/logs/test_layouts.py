"""Messages that begin alike, and stamps of headers."""

import struct
from typing import NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs.fields import FieldError
from mpap_cli.logs.files.runs import group_messages
from mpap_cli.logs.layouts import header_stamps, locate_alike
from mpap_cli.logs.raw import RawMessage, RawRun, Topic

HEAD = 12  # what stands before the name, whose first byte tells its length


class Named(NamedTuple):
    """A layout that knows the name before the numbers."""

    place: int
    n_bytes: int
    name: bytes


def locate(payload: bytes, encoding: str) -> Named:
    """Read a message of a head, a name and two bytes."""
    if encoding != "cdr" or len(payload) <= HEAD:
        msg = "no head"
        raise FieldError(msg)
    place = HEAD + 1 + payload[HEAD]
    if place + 2 > len(payload):
        msg = "cut short"
        raise FieldError(msg)
    return Named(place, 2, payload[HEAD + 1 : place])


def message(name: bytes, stamp: bytes = b"12345678", numbers: bytes = b"xy") -> bytes:
    """Write such a message."""
    return b"\0\1\0\0" + stamp + bytes([len(name)]) + name + numbers


def run_of(encoding: str, payloads: list[bytes]) -> RawRun:
    """Put payloads behind one another, as a log has them."""
    topic = Topic("/odom", "a/msg/B", encoding, len(payloads), "", "")
    messages = (RawMessage(topic, 10 * n, payload) for n, payload in enumerate(payloads))
    ((run,),) = (group.runs for group in group_messages(messages))
    return run


broken = st.sampled_from([b"", message(b"ab")[:-1], message(b"abc")[:HEAD]])
whole = st.builds(
    message,
    st.sampled_from([b"", b"a", b"ab", b"ba", b"abcd"]) | st.binary(min_size=1, max_size=2),
    st.binary(min_size=8, max_size=8),
    st.binary(min_size=2, max_size=3),
)


@given(payloads=st.lists(whole | broken, min_size=1, max_size=40))
def test_layouts_are_those_of_single_messages(payloads: list[bytes]) -> None:
    """However many there are, and whatever is broken."""
    run = run_of("cdr", payloads)

    kinds, layouts, skipped = locate_alike(run, locate)

    n_left_out = 0
    for number, kind in enumerate(kinds):
        try:
            expected = locate(run.payload(number), "cdr")
        except FieldError:
            assert kind == -1
            n_left_out += 1
        else:
            assert layouts[kind] == expected
    assert skipped.total() == n_left_out


@pytest.mark.parametrize(("ignored", "n_layouts"), [([], 2), ([slice(-1, None)], 1)])
def test_bytes_that_do_not_matter_may_differ(ignored: list[slice], n_layouts: int) -> None:
    """They count from the numbers back."""
    run = run_of("cdr", [message(b"ab"), message(b"ac"), message(b"ab")])

    _, layouts, _ = locate_alike(run, locate, ignored)

    assert len(layouts) == n_layouts


def test_stamps_of_headers() -> None:
    """Either byte order is read; what is too short or no plain CDR is told."""
    words = (7, 123, 0)
    payloads = [
        b"\0\1\0\0" + struct.pack("<III", *words),
        b"\0\0\0\0" + struct.pack(">III", *words),
        b"\0\1\0\0" + struct.pack("<II", *words[:2]),
        b"\0\5\0\0" + struct.pack("<III", *words),
        b"",
        b"\0\1\0\0" + struct.pack("<III", *words),
    ]

    stamps_ns, readable = header_stamps(run_of("cdr", payloads))
    of_ros1, all_readable = header_stamps(run_of("ros1", [payloads[0]]))

    assert readable.tolist() == [True, True, False, False, False, True]
    assert stamps_ns[readable].tolist() == [7_000_000_123] * 3
    assert (of_ros1.tolist(), all_readable.tolist()) == ([7_000_000_123], [True])
