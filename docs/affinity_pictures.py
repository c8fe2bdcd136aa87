"""Schematics of affinity propagation: the messages, and a run from start to end."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from docs.svg_picture import BLUE, GRAY, PALE, VERMILION, Picture, Point

Matrix = NDArray[np.float64]

_POINTS: tuple[Point, ...] = (
    # three heaps, in pixels of a panel
    *((38, 60), (62, 40), (70, 72), (46, 88), (88, 52)),
    *((150, 46), (172, 66), (190, 40), (164, 90), (198, 78)),
    *((84, 168), (112, 150), (122, 184), (98, 198), (146, 172), (66, 186)),
)
_SHOWN = (1, 6, 12, 60)
_DAMPING = 0.7
_COLORS = {"i": BLUE, "k": VERMILION}
_PANEL = 236


class _Message(NamedTuple):
    """One kind of message: what is sent from whom to whom, and what is heard before."""

    title: str
    sent: str
    sender: str
    receiver: str
    neighbor: str
    heard: str


@dataclass(frozen=True, slots=True)
class _State:
    """Responsibilities (n, n) after some iterations, and who is an exemplar (n,)."""

    iteration: int
    responsibilities: Matrix
    is_exemplar: NDArray[np.bool_]


def messages() -> Picture:
    """Draw what goes into the two messages between nodes (Fig. 2)."""
    words = "The two messages of affinity propagation, and the messages they are made of"
    picture = Picture(900, 300, words)
    first = _Message("responsibility, equation 4", "r(i, k)", "i", "k", "k'", "a(i, k')")
    second = _Message("availability, equations 5 and 6", "a(i, k)", "k", "i", "i'", "r(i', k)")
    _draw_message(picture, 0, first)
    _draw_message(picture, 450, second)
    lines = ("how well k would stand for i, beside all others", "how many others count on k")
    for x, line in zip((0, 450), lines, strict=True):
        picture.text((x + 225, 284), line, align="middle", color=PALE)
    return picture


def _draw_message(picture: Picture, left: int, message: _Message) -> None:
    """Draw a node that hears from its neighbors and sends one message on."""
    at, to = (left + 150, 150), (left + 390, 150)
    picture.text((left + 225, 30), message.title, bold=True, align="middle", size=16)
    for x, y in ((left + 50, 70), (left + 30, 150), (left + 50, 230)):
        picture.circle((x, y), 20, GRAY)
        picture.text((x, y + 5), message.neighbor, align="middle")
        dx, dy = at[0] - x, at[1] - y
        far = int((dx * dx + dy * dy) ** 0.5)
        start = (x + 22 * dx // far, y + 22 * dy // far)
        end = (at[0] - 28 * dx // far, at[1] - 28 * dy // far)
        picture.arrow(start, end)
    picture.text((left + 120, 92), message.heard, color=PALE)
    picture.arrow((at[0] + 26, at[1]), (to[0] - 28, to[1]), width=3.6)
    picture.text((left + 270, 138), message.sent, bold=True, align="middle")
    for center, name in ((at, message.sender), (to, message.receiver)):
        picture.circle(center, 24, _COLORS[name])
        picture.text((center[0], center[1] + 6), name, bold=True, align="middle", size=16)


def run_states() -> Picture:
    """Draw some states of one run of affinity propagation (Fig. 3)."""
    words = "States of one run of affinity propagation: messages between sixteen points"
    picture = Picture(4 * _PANEL, 264, words)
    for number, state in enumerate(_run()):
        left = number * _PANEL
        _draw_state(picture, left, state)
        name = f"after {state.iteration} iteration{'s' if state.iteration > 1 else ''}"
        picture.text((left + _PANEL // 2, 250), name, align="middle", color=PALE)
    return picture


def _draw_state(picture: Picture, left: int, state: _State) -> None:
    """Draw each point's messages to the others, the darker the higher; exemplars are red."""
    places = [(left + 4 + x, y) for x, y in _POINTS]
    for sender, row in enumerate(state.responsibilities):
        for receiver in np.flatnonzero(_darkness(row, sender) > 0).tolist():
            opacity = float(_darkness(row, sender)[receiver])
            picture.arrow(places[sender], places[receiver], width=1.2, opacity=opacity)
    for place, chosen in zip(places, state.is_exemplar.tolist(), strict=True):
        picture.dots(VERMILION if chosen else BLUE, place)
        if chosen:
            picture.circle(place, 9, VERMILION)


def _darkness(row: Matrix, sender: int) -> Matrix:
    """Return how dark the arrows of one sender are, 0 to 1 in tenths: its own count too."""
    usual = float(np.median(np.abs(row)))
    shares = np.exp((row - row.max()) / max(usual, 1.0) * 4)
    shares[sender] = 0.0
    return np.asarray(np.floor(10 * shares) / 10)


def _run() -> list[_State]:
    """Pass messages between the points (equations 4 to 6), and keep the states shown."""
    x = np.array(_POINTS, dtype=np.float64)
    s = -((x[:, None] - x) ** 2).sum(axis=2)
    n = len(s)
    own = np.eye(n, dtype=np.bool_)
    s[own] = np.median(s[~own])
    r, a = np.zeros((n, n)), np.zeros((n, n))
    states = []
    for iteration in range(1, max(_SHOWN) + 1):
        total = a + s
        best = np.array([np.delete(total, k, axis=1).max(axis=1) for k in range(n)]).T
        r = _DAMPING * r + (1 - _DAMPING) * (s - best)
        heard = np.where(own, r, np.maximum(r, 0.0))
        sums = heard.sum(axis=0) - heard
        a = _DAMPING * a + (1 - _DAMPING) * np.where(own, sums, np.minimum(sums, 0.0))
        if iteration in _SHOWN:
            states.append(_State(iteration, r.copy(), np.diag(r + a) > 0))
    return states
