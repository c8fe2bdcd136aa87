"""Items made ahead arrive in order, with errors where they belong."""

import threading
from collections.abc import Iterator
from itertools import count

import pytest

from mpap_cli.systems.stream import prefetch


@pytest.mark.parametrize("jobs", [1, 2, 8])
def test_items_keep_their_order(jobs: int) -> None:
    """Whatever the number of jobs."""
    assert list(prefetch(range(50), jobs)) == list(range(50))


@pytest.mark.parametrize("jobs", [1, 2])
def test_an_exception_comes_where_it_was_raised(jobs: int) -> None:
    """Items before it are not lost."""

    def items() -> Iterator[int]:
        yield 1
        yield 2
        msg = "broken"
        raise ValueError(msg)

    got: list[int] = []
    with pytest.raises(ValueError, match="broken"):
        got.extend(prefetch(items(), jobs))

    assert got == [1, 2]


def test_no_more_than_depth_items_wait() -> None:
    """The queue is bounded: one more is in the making at most."""
    made: list[int] = []
    third = threading.Event()

    def items() -> Iterator[int]:
        for item in count():
            made.append(item)
            if item == 2:
                third.set()
            yield item

    ahead = prefetch(items(), 2, depth=1)
    next(ahead)
    third.wait(5)
    ahead.close()  # type: ignore[attr-defined]  # it is a generator

    assert len(made) <= 5


def test_who_stops_early_leaves_no_thread() -> None:
    """The source is closed and its thread is over."""
    closed = threading.Event()

    def items() -> Iterator[int]:
        try:
            yield from count()
        finally:
            closed.set()

    for item in (ahead := prefetch(items(), 2)):
        if item == 3:
            break
    ahead.close()  # type: ignore[attr-defined]  # it is a generator

    assert closed.is_set()
    assert not [thread for thread in threading.enumerate() if thread.name == "mpap-prefetch"]


@pytest.mark.parametrize("depth", [1, 2])
def test_a_source_that_hangs_keeps_nobody_waiting(depth: int) -> None:
    """Its thread is left behind, and ends as soon as the source goes on."""
    goes_on = threading.Event()

    def items() -> Iterator[int]:
        yield 1
        goes_on.wait(60)
        yield from count()

    ahead = prefetch(items(), 2, depth)
    next(ahead)
    ahead.close()  # type: ignore[attr-defined]  # it is a generator
    left = [thread for thread in threading.enumerate() if thread.name == "mpap-prefetch"]
    goes_on.set()
    for thread in left:
        thread.join(10)

    assert len(left) == 1
    assert not left[0].is_alive()
