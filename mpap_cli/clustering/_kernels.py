"""Compiled loops of affinity propagation.

Sums run in a fixed order in float64, so that results do not depend on the processor.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from mpap_cli.observations import BoolArray, Float64Array, IntArray

_compiled = njit(nogil=True, cache=True, error_model="numpy")
_LANES = 32


class Messages(NamedTuple):
    """Responsibilities and availabilities of affinity propagation, and their sums.

    ``a`` and ``r`` have shape (n, n); the diagonal of a is up to date in ``a_diagonal``.
    ``support`` (n,) is what an item gets in positive responsibilities from the others,
    ``offer`` (n,) that plus its self-responsibility.
    """

    a: Float64Array
    r: Float64Array
    a_diagonal: Float64Array
    r_diagonal: Float64Array
    support: Float64Array
    offer: Float64Array


def start_messages(a: Float64Array, r: Float64Array) -> Messages:
    """Set both messages to zero (section 3.2)."""
    a[:] = 0.0
    r[:] = 0.0
    n = len(a)
    return Messages(a, r, np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n))


def pass_messages(s: Float64Array, messages: Messages, damping: float) -> BoolArray:
    """Do one iteration of equations 4 to 6; return which items are exemplars."""
    _sweep(s, messages, damping, np.empty((2, _LANES)))
    is_exemplar: BoolArray = messages.a_diagonal + messages.r_diagonal > 0
    return is_exemplar


@_compiled
def _sweep(s: Float64Array, m: Messages, damping: float, lanes: Float64Array) -> None:
    """Finish the availabilities of the last iteration and renew the responsibilities.

    Equations 5 and 6 need whole columns of r, so a row of a is brought up to date only
    when the same row of r is due: each matrix is gone through once an iteration. The two
    largest values are kept in lanes, since one running maximum would not be vectorised.
    """
    n = len(s)
    new = 1.0 - damping
    top, runner_up = lanes[0], lanes[1]
    support, offer = m.support, m.offer
    whole = n - n % _LANES
    support[:] = 0.0
    for i in range(n):
        si, ai, ri = s[i], m.a[i], m.r[i]
        for k in range(n):  # equation 5
            ai[k] = damping * ai[k] + new * min(0.0, offer[k] - max(0.0, ri[k]))
        ai[i] = m.a_diagonal[i]
        top[:] = -np.inf
        runner_up[:] = -np.inf
        for start in range(0, whole, _LANES):
            for lane in range(_LANES):
                x = ai[start + lane] + si[start + lane]
                runner_up[lane] = max(runner_up[lane], min(top[lane], x))
                top[lane] = max(top[lane], x)
        first = second = -np.inf
        for lane in range(_LANES):
            second = max(second, runner_up[lane], min(first, top[lane]))
            first = max(first, top[lane])
        for k in range(whole, n):
            x = ai[k] + si[k]
            second = max(second, min(first, x))
            first = max(first, x)
        for k in range(n):  # equation 4; first and second are a_ik' + s_ik'
            other = second if ai[k] + si[k] == first else first
            x = damping * ri[k] + new * (si[k] - other)
            ri[k] = x
            support[k] += max(0.0, x)
        m.r_diagonal[i] = ri[i]
        support[i] -= max(0.0, ri[i])
    for k in range(n):  # equation 6
        m.a_diagonal[k] = damping * m.a_diagonal[k] + new * support[k]
        offer[k] = m.r_diagonal[k] + support[k]


def net_similarity(s: Float64Array, exemplars: IntArray) -> float:
    """Sum of s(i, c_i) when every item goes to its best exemplar (equation 2)."""
    return float(_net_similarity(s, exemplars))


@_compiled
def _net_similarity(s: Float64Array, exemplars: IntArray) -> float:
    total = 0.0
    for i in range(len(s)):
        best = -np.inf
        for k in exemplars:
            if k == i:
                best = s[i, i]
                break
            best = max(best, s[i, k])
        total += best
    return total
