"""Labels of observations around presses."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.observations import NS_PER_S, Int8Array, IntArray, Press
from mpap_cli.params import PropertyParams
from mpap_cli.properties.labels import (
    label_contact,
    label_early,
    label_onset,
    label_scans,
    press_starts,
)

ONE_S = PropertyParams()


@st.composite
def press_lists(draw: st.DrawFn) -> tuple[Press, ...]:
    """Presses apart from each other; the first may be held."""
    steps = draw(st.lists(st.tuples(st.integers(1, 4000), st.integers(1, 4000)), max_size=6))
    held, at, presses = draw(st.booleans()), 0, list[Press]()
    for gap, length in steps:
        start = at + gap * 1_000_000
        at = start + length * 1_000_000
        presses.append(Press(start, at, held_from_start=held and not presses))
    return tuple(presses)


def reference(stamp_ns: int, presses: tuple[Press, ...]) -> tuple[int, int, int]:
    """Label one observation as the definition says, with windows of one second."""
    contact = onset = early = 0
    for press in presses:
        since = -(10**18) if press.held_from_start else press.start_ns
        if press.start_ns <= stamp_ns < press.end_ns:
            contact = 1
        if since <= stamp_ns < press.end_ns + NS_PER_S:
            onset = -1
        if since <= stamp_ns < press.end_ns:
            early = -1
    for press in presses:
        if press.held_from_start:
            continue
        if press.start_ns <= stamp_ns < min(press.end_ns, press.start_ns + NS_PER_S):
            onset = 1
        if stamp_ns < press.start_ns <= stamp_ns + NS_PER_S and early != -1:
            early = 1
    return contact, onset, early


@given(press_lists(), st.lists(st.integers(0, 40_000), max_size=20))
def test_labels_follow_their_definition(presses: tuple[Press, ...], at_ms: list[int]) -> None:
    """Also for stamps in no order and presses close to each other."""
    stamps_ns = np.array(at_ms, dtype=np.int64) * 1_000_000

    labels = label_scans(stamps_ns, presses, ONE_S)

    assert labels.dtype == np.int8
    assert labels.tolist() == [list(reference(stamp, presses)) for stamp in stamps_ns.tolist()]


def test_a_held_press_has_no_onset_and_no_warning() -> None:
    """Under contact it counts from its first message; else it has no label, before too."""
    stamps_ns = np.array([0, 2, 3, 4, 5]) * NS_PER_S
    presses = [Press(1 * NS_PER_S, 4 * NS_PER_S, held_from_start=True)]

    labels = label_scans(stamps_ns, presses, ONE_S)

    assert labels.T.tolist() == [[0, 1, 1, 0, 0], [-1, -1, -1, -1, 0], [-1, -1, -1, 0, 0]]


def test_an_onset_inside_the_release_second_of_the_press_before_is_positive() -> None:
    """The second press begins while the first one still silences what is free."""
    presses = [Press(0, NS_PER_S), Press(NS_PER_S + 5, NS_PER_S + 7)]

    labels = label_onset(np.array([NS_PER_S + 4, NS_PER_S + 5, NS_PER_S + 7]), presses)

    assert labels.tolist() == [-1, 1, -1]


@pytest.mark.parametrize("label", [label_contact, label_onset, label_early])
def test_without_presses_everything_is_negative(
    label: Callable[[IntArray, tuple[Press, ...]], Int8Array],
) -> None:
    """A bumper that was never pressed says that all is free."""
    assert label(np.array([0, 5, 2**62]), ()).tolist() == [0, 0, 0]


def test_labels_leave_their_input_alone() -> None:
    """Stamps are read only."""
    stamps_ns = np.array([3, 1, 2])
    stamps_ns.flags.writeable = False

    label_scans(stamps_ns, [Press(1, 2, held_from_start=True)], ONE_S)

    assert stamps_ns.tolist() == [3, 1, 2]


def test_press_starts_tell_presses_apart() -> None:
    """A press that is held counts from its first message."""
    starts = press_starts(np.array([1, 2, 5, 9]), [Press(2, 4, held_from_start=True), Press(9, 10)])

    assert starts.tolist() == [-1, 2, 2, 9]
