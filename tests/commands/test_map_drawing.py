"""Which patches stand on the map."""

import numpy as np

from mpap_cli.commands.predicting.map_drawing import _gap, _Sighting, _spread
from mpap_cli.outputs.map_plot import MOST_PATCHES

PICTURE = np.zeros((4, 4, 3), np.uint8)


def sightings(*places: tuple[float, float]) -> list[_Sighting]:
    """Return sightings of one kind at these places."""
    return [_Sighting(PICTURE, 0.5, np.array(place)) for place in places]


def test_each_kind_is_shown_before_any_is_shown_twice() -> None:
    """Of a kind the sighting that is farthest from the patches chosen before is taken."""
    first, second = sightings((0.0, 0.0), (9.0, 0.0)), sightings((0.1, 0.0), (5.0, 0.0))

    chosen = _spread([first, second])

    assert chosen[0] is first[0]
    assert chosen[1] is second[1]
    assert len(chosen) == 4


def test_no_more_are_shown_than_fit() -> None:
    """Many sightings: as many as the map holds, and no two at one place."""
    chosen = _spread([sightings(*((float(x), float(y)) for x in range(6))) for y in range(5)])

    assert len(chosen) == MOST_PATCHES
    assert min(_gap(one.place, [two for two in chosen if two is not one]) for one in chosen) >= 1


def test_nothing_seen_is_nothing_shown() -> None:
    """Without a kind there is no patch."""
    assert _spread([]) == []
    assert _gap(np.zeros(2), []) == np.inf
