"""Fields read where they lie in a payload."""

import struct
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs.cursor import Cursor
from mpap_cli.logs.fields import FieldError

ENCAPSULATIONS = {0: ">", 1: "<", 6: ">", 7: "<"}


def at(payload: bytes, encoding: str = "cdr") -> Cursor:
    """Begin to read a message."""
    return Cursor(memoryview(payload), encoding, "an image")


@pytest.mark.parametrize(("kind", "order"), ENCAPSULATIONS.items())
def test_cdr_aligns_numbers_in_either_byte_order(kind: int, order: str) -> None:
    """Behind a text of one byte and its NUL two bytes are passed over."""
    numbers = struct.pack(order + "III2sxxI", 7, 5, 2, b"a\0", 9)
    cursor = at(bytes([0, kind, 0, 0]) + numbers)

    found = cursor.stamp_ns(), cursor.text(), cursor.number()

    assert found == (7_000_000_005, "a", 9)


@pytest.mark.parametrize(("kind", "padding"), [(0, 4), (1, 4), (6, 0), (7, 0)])
def test_numbers_of_eight_bytes_are_aligned_by_the_version_of_cdr(kind: int, padding: int) -> None:
    """To 8 bytes behind the encapsulation in the first version, to 4 in the second."""
    dtype = ENCAPSULATIONS[kind] + "f8"
    head = struct.pack(ENCAPSULATIONS[kind] + "I", 3)
    numbers = struct.pack(ENCAPSULATIONS[kind] + "2d", 1.5, 2.5)
    payload = bytes([0, kind, 0, 0]) + head + bytes(padding) + numbers
    cursor = at(payload)
    cursor.number()

    place, found = cursor.doubles(2)

    assert (place, found) == (8 + padding, np.dtype(dtype))
    with pytest.raises(FieldError, match=r"^an image cut short$"):
        cursor.byte()


def test_ros1_aligns_nothing() -> None:
    """A sequence number first; texts have no NUL."""
    cursor = at(struct.pack("<IIII1sBI", 99, 7, 5, 1, b"a", 4, 9), "ros1")

    found = cursor.stamp_ns(), cursor.text(), cursor.byte(), cursor.number()

    assert found == (7_000_000_005, "a", 4, 9)


@given(payload=st.binary(max_size=40), encoding=st.sampled_from(["cdr", "ros1"]))
def test_any_bytes_make_fields_or_a_field_error(payload: bytes, encoding: str) -> None:
    """What a message declares is believed within its bytes only."""
    with suppress(FieldError):
        cursor = at(payload, encoding)
        cursor.stamp_ns()
        cursor.text()
        assert len(cursor.sequence()) <= len(payload)
        assert cursor.doubles(1)[0] + 8 <= len(payload)


def test_text_that_is_no_utf8_is_marked() -> None:
    """It is no error: nothing but a name is wrong."""
    cursor = at(struct.pack("<II3s", 0, 3, b"a\xff\0"), "ros1")

    assert cursor.text() == "a\N{REPLACEMENT CHARACTER}"
