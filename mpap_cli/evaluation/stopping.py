"""Where the robot would have stopped, and which contacts it would have avoided (section 5.3.3).

The log was not driven by these decisions, so a stopping distance is counterfactual: how
near the nearest thing ahead was when the decision first turned against going on.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.leads import GAP_NS, Lead
from mpap_cli.observations import NS_PER_S, BoolArray, Float64Array, Int8Array, IntArray, Press
from mpap_cli.systems.decision import STRAIGHT

STRAIGHT_NS = NS_PER_S
APPROACH_NS = 5 * NS_PER_S


@dataclass(frozen=True, slots=True, eq=False)
class Stops:
    """Moments at which the decision first turned against going on, in one log.

    ``index`` (m,) into the decisions; ``distance_m`` (m,) to the nearest return ahead of
    the scanner, NaN where it saw nothing there or no scan is near in time.
    """

    index: IntArray
    distance_m: Float64Array


@dataclass(frozen=True, slots=True)
class StoppingSummary:
    """Stopping distance over all stops: mean and sample standard deviation in metres.

    ``measured`` of the ``stops`` have a distance; ``mean_m`` is None without any,
    ``sd_m`` with fewer than two.
    """

    stops: int
    measured: int
    mean_m: float | None
    sd_m: float | None


def stopping_distances(
    stamps_ns: IntArray,
    actions: Int8Array,
    nearest_ahead_m: Float64Array,
    driving: BoolArray | None = None,
) -> Stops:
    """Find where an approach of one log would have ended (section 5.3.3).

    Parameters
    ----------
    stamps_ns : ndarray of shape (n,)
        Stamps of the decisions, not decreasing.
    actions : ndarray of shape (n,)
        Decisions, indices into :data:`mpap_cli.systems.decision.ACTIONS`.
    nearest_ahead_m : ndarray of shape (n,)
        Nearest range ahead at these moments, NaN where there is none.
    driving : ndarray of shape (n,), optional
        Where the robot drives forward; only there can a decision be a stop. Without, a
        robot that turns in place towards a wall counts as stopped by it.

    Returns
    -------
    Stops
        The first decision other than straight after straight ones for a second or more;
        a pause of more than two seconds between decisions begins anew.

    Examples
    --------
    >>> stamps_ns = np.arange(5) * NS_PER_S // 2
    >>> actions = np.array([0, 0, 2, 2, 0], np.int8)
    >>> stops = stopping_distances(stamps_ns, actions, np.linspace(2, 1, 5))
    >>> stops.index.tolist(), stops.distance_m.tolist()
    ([2], [1.5])
    """
    straight = actions == STRAIGHT
    follows = np.diff(stamps_ns, prepend=stamps_ns[:1]) <= GAP_NS
    was_straight = np.concatenate(([False], straight[:-1])) & follows
    begins = straight & ~was_straight
    first = np.maximum.accumulate(np.where(begins, np.arange(straight.size), 0))
    since_ns = stamps_ns - stamps_ns[np.concatenate((first[:1], first[:-1]))]
    stops = ~straight & was_straight & (since_ns >= STRAIGHT_NS)
    if driving is not None:
        stops &= driving
    index = np.flatnonzero(stops)
    return Stops(index, nearest_ahead_m[index].astype(np.float64))


def summarize_stops(stops: Sequence[Stops]) -> StoppingSummary:
    """Join the stops of several logs."""
    every = np.concatenate([one.distance_m for one in stops]) if stops else np.empty(0)
    seen = every[~np.isnan(every)]
    return StoppingSummary(
        stops=every.size,
        measured=seen.size,
        mean_m=float(seen.mean()) if seen.size else None,
        sd_m=float(seen.std(ddof=1)) if seen.size > 1 else None,
    )


def announced_contacts(
    stamps_ns: IntArray,
    actions: Int8Array,
    presses: Sequence[Press],
    driving: BoolArray | None = None,
) -> list[Lead]:
    """Judge for each press of one log whether a stop or turn was decided before it.

    Parameters
    ----------
    stamps_ns, actions, driving
        Those of :func:`stopping_distances`.
    presses : sequence of Press
        Presses of the log, in time order.

    Returns
    -------
    list of Lead
        ``predicted``: a decision other than straight came within the approach; ``lead_s``
        from the first such to the press. Both None where no decision was made in the
        approach, or the press was on from the start.

    Notes
    -----
    The approach are the last five seconds before the press, as long as the one before it
    is over and, with ``driving``, the robot drives forward without a break: what is
    decided while it still backs off or turns away from the last thing says nothing.
    A robot that obeys stops at the first such decision, so the contact would not have
    been, whatever is decided of the pictures behind it. Decisions that hold until
    the press are those of :class:`mpap_cli.evaluation.leads.PressJudge`.
    """
    leads = []
    free_ns = np.iinfo(np.int64).min
    for press in presses:
        since_ns = max(press.start_ns - APPROACH_NS, free_ns)
        first, after = np.searchsorted(stamps_ns, (since_ns, press.start_ns)).tolist()
        if driving is not None:
            breaks = np.flatnonzero(~driving[first:after])
            first = first + int(breaks[-1]) + 1 if breaks.size else first
        free_ns = max(free_ns, press.end_ns)
        if press.held_from_start or first == after:
            leads.append(Lead(None, None))
            continue
        against = np.flatnonzero(actions[first:after] != STRAIGHT)
        if against.size:
            begun_ns = int(stamps_ns[first + int(against[0])])
            leads.append(Lead(True, (press.start_ns - begun_ns) / NS_PER_S))
        else:
            leads.append(Lead(False, 0.0))
    return leads
