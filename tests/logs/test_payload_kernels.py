"""Stamps, comparisons and copies of payloads, and steps of clocks, against plain Python."""

import struct
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.logs import _kernels as kernels
from mpap_cli.observations import IntArray

ORDERS = np.zeros(256, np.uint8)
ORDERS[:4] = [kernels.BIG, kernels.LITTLE, kernels.UNKNOWN, kernels.LITTLE]


@pytest.fixture(params=["compiled", "plain"])
def kind(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Run a test with the compiled loops, and with what they were compiled from."""
    if request.param == "plain":
        for name, kernel in list(vars(kernels).items()):
            if hasattr(kernel, "py_func"):
                monkeypatch.setattr(kernels, name, kernel.py_func)
    return str(request.param)


def laid_out(texts: list[bytes]) -> tuple[bytes, IntArray, IntArray]:
    """Put payloads behind one another; return them, their starts and their sizes."""
    sizes = np.array([len(text) for text in texts])
    return b"".join(texts), np.cumsum(sizes) - sizes, sizes


@pytest.mark.usefixtures("kind")
def test_heads_are_compared_under_a_mask() -> None:
    """With the first payload; those too short are not alike, whatever they begin with."""
    texts = [b"abcde", b"abXde", b"abcd", b"abcdefg", b"Xbcde", b"abcXe"]
    records, starts, sizes = laid_out(texts)
    mask = np.array([255, 255, 0, 255], np.uint8)

    alike = kernels.find_alike(records, starts, sizes, 5, mask)

    assert alike.tolist() == [True, True, False, True, False, False]


@pytest.mark.usefixtures("kind")
def test_rows_are_copied_and_end_where_the_bytes_end() -> None:
    """Nothing behind the bytes at hand is ever copied."""
    rows = np.zeros((2, 4), np.uint8)

    kernels.gather_into(b"12345678", np.array([4, 0]), rows)

    assert [bytes(row) for row in rows] == [b"5678", b"1234"]
    with pytest.raises(ValueError):  # noqa: PT011  # a kernel has no words
        kernels.gather_into(b"12345678", np.array([0, 5]), rows)


@pytest.mark.usefixtures("kind")
def test_stamps_lie_behind_the_byte_that_tells_their_order() -> None:
    """The last payload reaches behind the bytes at hand and is as short as those."""
    heads = [
        b"\0\1\0\0" + struct.pack("<II4x", 7, 123),
        b"\0\0\0\0" + struct.pack(">II4x", 2**32 - 1, 5),
        b"\0\1\0\0" + struct.pack("<II3x", 7, 123),
        b"\0\2\0\0" + struct.pack("<II4x", 1, 1),
        b"\0\3\0\0" + struct.pack("<II4x", 3, 2**32 - 1) + b"more",
        b"\0\1\0\0" + struct.pack("<I", 9),
    ]
    records, starts, sizes = laid_out(heads)
    sizes[-1] = 100

    stamps_ns, readable = kernels.read_stamps(records, starts, sizes, ORDERS)

    assert readable.tolist() == [True, True, False, False, True, False]
    assert stamps_ns[readable].tolist() == [
        7 * 10**9 + 123,
        (2**32 - 1) * 10**9 + 5,
        3 * 10**9 + 2**32 - 1,
    ]
    assert stamps_ns[[2, 5]].tolist() == [0, 0]


steps = st.tuples(st.integers(-3, 9), st.integers(-3, 9), st.booleans())


@given(steps=st.lists(steps, max_size=12), cut=st.integers(0, 12))
def test_steps_of_two_clocks_are_added_up_over_pieces(
    steps: list[tuple[int, int, bool]], cut: int
) -> None:
    """Where they part, pause and fall is what a loop over all pairs finds, wherever it is cut."""
    moves = np.array([step[:2] for step in steps], np.int64).reshape(-1, 2).cumsum(axis=0) + 50
    used = np.array([step[2] for step in steps], np.bool_)
    last_ns, found = np.array([-1, 0, 0]), np.zeros((3, 3), np.int64)
    limits_ns = np.array([2, 5])

    for part in (slice(cut), slice(cut, None)):
        recorded_ns, own_ns = moves[part].T.copy()
        kernels.measure_steps(recorded_ns, own_ns, used[part], last_ns, limits_ns, found)

    pairs = list(pairwise(moves[used].tolist()))
    both = [((b[0], abs((b[0] - a[0]) - (b[1] - a[1])))) for a, b in pairs]
    jumps = [(at, length) for at, length in both if length > 2]
    pauses = [(a[0], b[0] - a[0]) for a, b in pairs if b[0] - a[0] > 5]
    expected = [
        [len(some), some[0][0] if some else 0, max((one[1] for one in some), default=0)]
        for some in (jumps, pauses)
    ]
    assert found.tolist() == [*expected, [sum(b[1] < a[1] for a, b in pairs), 0, 0]]


def test_steps_as_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """The loop does the same uncompiled."""
    recorded_ns, own_ns = np.array([0, 1, 9, 10, 11]), np.array([0, 5, 6, 4, 5])
    used = np.array([True, True, True, True, False])
    tables = []

    for kernel in (kernels._measure_steps, kernels._measure_steps.py_func):
        monkeypatch.setattr(kernels, "_measure_steps", kernel)
        last_ns, found = np.array([-1, 0, 0]), np.zeros((3, 3), np.int64)
        kernels.measure_steps(recorded_ns, own_ns, used, last_ns, np.array([2, 5]), found)
        tables.append((found.tolist(), last_ns.tolist()))

    assert tables[0] == tables[1]
    assert tables[0][0] == [[3, 1, 7], [1, 1, 8], [1, 0, 0]]
