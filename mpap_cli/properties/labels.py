"""Labels of observations from the presses of their log (section 4.1).

A label is 1 (positive), 0 (negative) or -1 (none: neither counted nor scored). A
meta-point counts three pairs of labels, in the order of :data:`mpap_cli.params.TARGETS`.
"""

from collections.abc import Sequence

import numpy as np

from mpap_cli.observations import NS_PER_S, BoolArray, Int8Array, IntArray, Press
from mpap_cli.params import PropertyParams

CONTACT, ONSET, EARLY = range(3)
NO_LABEL = -1
_LONG_AGO_NS = np.iinfo(np.int64).min // 2
_NEVER_NS = np.iinfo(np.int64).max


def label_scans(stamps_ns: IntArray, presses: Sequence[Press], params: PropertyParams) -> Int8Array:
    """Label observations under all three targets.

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        In any order.
    presses : sequence of Press
        Of the same log, apart from each other and in time order.
    params : PropertyParams
        ``onset_s``, ``release_s``, ``early_s``.

    Returns
    -------
    ndarray of shape (n, 3)
        Columns contact, onset, early.

    Examples
    --------
    >>> label_scans(np.array([0, 5]), [Press(4, 9)], PropertyParams()).tolist()
    [[0, 0, 1], [1, 1, -1]]
    """
    columns = (
        label_contact(stamps_ns, presses),
        label_onset(stamps_ns, presses, params.onset_s, params.release_s),
        label_early(stamps_ns, presses, params.early_s),
    )
    return np.stack(columns, axis=1)


def label_contact(stamps_ns: IntArray, presses: Sequence[Press]) -> Int8Array:
    """Label the observations made during a press.

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        In any order.
    presses : sequence of Press
        Of the same log, apart from each other and in time order.

    Returns
    -------
    ndarray of shape (n,)
        1 where start <= stamp < end of a press, else 0.

    Examples
    --------
    >>> label_contact(np.array([9, 10, 19, 20]), [Press(10, 20)]).tolist()
    [0, 1, 1, 0]
    """
    starts, ends, _ = _bounds(presses)
    return (stamps_ns < ends[_begun(stamps_ns, starts)]).astype(np.int8)


def label_onset(
    stamps_ns: IntArray, presses: Sequence[Press], onset_s: float = 1.0, release_s: float = 1.0
) -> Int8Array:
    """Label the first moments of each press.

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        In any order.
    presses : sequence of Press
        Of the same log, apart from each other and in time order.
    onset_s, release_s : float
        Seconds of a press that count; seconds without label after its release.

    Returns
    -------
    ndarray of shape (n,)
        1 during the first ``onset_s`` of a press, -1 from then until ``release_s``
        after its release, else 0. A press that is held when the log starts has no
        onset: -1 from the start of the log until ``release_s`` after its release.

    Examples
    --------
    >>> stamps_ns = np.array([0, 4, 5, 6, 7]) * NS_PER_S
    >>> label_onset(stamps_ns, [Press(4 * NS_PER_S, 6 * NS_PER_S)]).tolist()
    [0, 1, -1, -1, 0]
    """
    starts, ends, held = _since_before(presses)
    press = _begun(stamps_ns, starts)
    labels = -(stamps_ns < ends[press] + _ns(release_s)).astype(np.int8)
    first = stamps_ns < np.minimum(starts + _ns(onset_s), ends)[press]
    labels[first & ~held[press]] = 1
    return labels


def label_early(stamps_ns: IntArray, presses: Sequence[Press], early_s: float = 1.0) -> Int8Array:
    """Label the observations shortly before a press.

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        In any order.
    presses : sequence of Press
        Of the same log, apart from each other and in time order.
    early_s : float
        Seconds of warning.

    Returns
    -------
    ndarray of shape (n,)
        1 where a press begins after the stamp and at most ``early_s`` later, -1 during
        a press (and before one that is held when the log starts), else 0.

    Examples
    --------
    >>> stamps_ns = np.array([2, 3, 4, 5]) * NS_PER_S
    >>> label_early(stamps_ns, [Press(4 * NS_PER_S, 5 * NS_PER_S)]).tolist()
    [0, 1, -1, 0]
    """
    starts, ends, _ = _since_before(presses)
    press = _begun(stamps_ns, starts)
    next_start = np.append(starts[1:], _NEVER_NS)[press]
    labels = (next_start - stamps_ns <= _ns(early_s)).astype(np.int8)
    labels[stamps_ns < ends[press]] = NO_LABEL
    return labels


def press_starts(stamps_ns: IntArray, presses: Sequence[Press]) -> IntArray:
    """Return the start of the last press that began at or before each stamp, else -1.

    >>> press_starts(np.array([9, 10, 30]), [Press(10, 20)]).tolist()
    [-1, 10, 10]
    """
    starts, _, _ = _bounds(presses)
    found = starts[_begun(stamps_ns, starts)]
    return np.where(found == _LONG_AGO_NS, -1, found)


def _bounds(presses: Sequence[Press]) -> tuple[IntArray, IntArray, BoolArray]:
    """Return starts, ends and held of the presses, behind one that is long over."""
    rows = [(_LONG_AGO_NS, _LONG_AGO_NS, 0)]
    rows += [(press.start_ns, press.end_ns, press.held_from_start) for press in presses]
    starts, ends, held = np.array(rows, dtype=np.int64).T
    return starts, ends, held == 1


def _since_before(presses: Sequence[Press]) -> tuple[IntArray, IntArray, BoolArray]:
    """Return the same, with a press that is held from the start reaching back for ever."""
    starts, ends, held = _bounds(presses)
    if held[1:2].any():
        starts = starts.copy()
        starts[1] = starts[0]
    return starts, ends, held


def _begun(stamps_ns: IntArray, starts: IntArray) -> IntArray:
    """Return the index of the last press that began at or before each stamp."""
    found: IntArray = np.searchsorted(starts, stamps_ns, side="right") - 1
    return found


def _ns(seconds: float) -> int:
    return round(seconds * NS_PER_S)
