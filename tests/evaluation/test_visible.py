"""A press is visible if something near was seen ahead in the second before it."""

import numpy as np
import pytest

from mpap_cli.errors import SettingError
from mpap_cli.evaluation.visible import nearest_before, visible_limit, visible_presses
from mpap_cli.observations import (
    NS_PER_S,
    Float32Array,
    ObservedLog,
    Press,
    ScanBlock,
    ScanGeometry,
)
from mpap_cli.params import EvaluationParams, ScanParams

N_BEAMS = 8
# Beams point to -180, -135, ... 135 degrees; the fifth looks ahead.
GEOMETRY = ScanGeometry(N_BEAMS, -np.pi, np.pi / 4, 0.1, 5.0)
AHEAD, AT_45, AT_90 = 4, 5, 6
SCAN, PARAMS = ScanParams(), EvaluationParams()


def ranges_of(n_scans: int) -> Float32Array:
    """Return scans of one beam each half second that see nothing."""
    return np.full((n_scans, N_BEAMS), np.inf, dtype=np.float32)


def log_of(
    ranges: Float32Array,
    forward_rad: float = 0.0,
    geometry: ScanGeometry = GEOMETRY,
    n_parts: int = 2,
) -> ObservedLog:
    """Make a log of two scans a second, cut into blocks."""
    stamps_ns = np.arange(len(ranges)) * (NS_PER_S // 2)
    parts = np.array_split(np.arange(len(ranges)), n_parts)
    blocks = [ScanBlock(stamps_ns[part], ranges[part], geometry) for part in parts]
    end_ns = int(stamps_ns[-1]) + 1
    return ObservedLog(
        "log", "log", 0, end_ns, forward_rad, None, (), "bumper", lambda: iter(blocks)
    )


def press(start_s: float, *, held: bool = False) -> Press:
    """Make a press of half a second."""
    start_ns = int(start_s * NS_PER_S)
    return Press(start_ns, start_ns + NS_PER_S // 2, held_from_start=held)


@pytest.mark.parametrize(
    ("scan", "beam", "range_m", "nearest"),
    [
        (4, AHEAD, 0.4, 0.4),
        (6, AHEAD, 0.4, 0.4),
        (3, AHEAD, 0.4, np.inf),
        (7, AHEAD, 0.4, np.inf),
        (5, AT_45, 0.4, 0.4),
        (5, AT_90, 0.4, np.inf),
        (5, 0, 0.4, np.inf),
        (5, AHEAD, 0.05, 0.1),
        (5, AHEAD, 0.0, np.inf),
        (5, AHEAD, np.nan, np.inf),
        (5, AHEAD, 5.1, np.inf),
    ],
)
def test_the_nearest_return_ahead_in_the_second_before_counts(
    scan: int, beam: int, range_m: float, nearest: float
) -> None:
    """From one second before the onset (3 s) up to it, 45 degrees to either side."""
    ranges = ranges_of(10)
    ranges[scan, beam] = range_m

    found = nearest_before(log_of(ranges), (press(3),), SCAN, 45.0)

    assert found.nearest_m == pytest.approx([nearest])


def test_ahead_is_where_the_robot_drives() -> None:
    """A scanner that is mounted backwards looks ahead with its first beam."""
    ranges = ranges_of(4)
    ranges[1, 0] = 0.3

    forwards = nearest_before(log_of(ranges), (press(1),), SCAN, 45.0)
    turned = nearest_before(log_of(ranges, forward_rad=np.pi), (press(1),), SCAN, 45.0)

    assert forwards.nearest_m.tolist() == [np.inf]
    assert turned.nearest_m == pytest.approx([0.3])


def test_without_scan_before_it_nothing_is_known_of_a_press() -> None:
    """Neither visible nor not: no scan in that second, or on from the start."""
    ranges = ranges_of(10)
    ranges[:, AHEAD] = 0.3
    presses = (press(0.5, held=True), press(3), press(8))

    (found,) = visible_presses([log_of(ranges)], [presses], SCAN, PARAMS)

    assert found == (None, True, None)


def test_a_hand_that_no_beam_sees_is_not_visible() -> None:
    """Only what is nearer than the limit counts; the limit is a setting."""
    ranges = ranges_of(10)
    ranges[:, AHEAD] = 0.9

    near = visible_presses([log_of(ranges)], [(press(3),)], SCAN, PARAMS)
    far = visible_presses([log_of(ranges)], [(press(3),)], SCAN, EvaluationParams(visible_m=1.0))

    assert near == ((False,),)
    assert far == ((True,),)


def test_a_scanner_far_behind_the_bumper_has_a_limit_of_its_own() -> None:
    """Its presses show what near means; those of another kind of scanner do not."""
    ranges = ranges_of(20)
    ranges[:, AHEAD] = 0.8
    ranges[15:, AHEAD] = 3.0
    presses = tuple(press(second) for second in (1, 3, 5, 9))
    other = ScanGeometry(N_BEAMS, -np.pi, np.pi / 4, 0.1, 30.0)
    far_behind = log_of(ranges)
    alone = log_of(ranges, geometry=other)

    found = visible_presses([far_behind, alone], [presses, presses[:1]], SCAN, PARAMS)

    assert found == ((True, True, True, False), (False,))


@pytest.mark.parametrize(
    ("nearest_m", "limit"),
    [
        ([], 0.6),
        ([0.8, 0.8, 0.8], 0.6),
        ([0.8, 0.8, 0.8, np.nan], 0.6),
        ([0.8, 0.8, 0.8, 0.8], 1.0),
        ([0.8, 2.0, 2.0, np.inf], 1.0),
        ([0.3, 0.3, 0.3, 0.3], 0.6),
        ([np.inf] * 8, 0.6),
        ([0.8, *[np.inf] * 8], 0.6),
    ],
)
def test_the_limit_is_never_less_than_the_setting(nearest_m: list[float], limit: float) -> None:
    """It needs four presses, of which a quarter was seen."""
    assert visible_limit(np.array(nearest_m), PARAMS) == pytest.approx(limit)


def test_logs_without_presses_are_not_read() -> None:
    """Nothing is asked of their scans."""
    log = log_of(ranges_of(4), geometry=ScanGeometry(N_BEAMS, -np.pi, np.pi / 4, 0.1, np.nan))

    assert visible_presses([log, log], [None, ()], SCAN, PARAMS) == ((), ())


@pytest.mark.parametrize(
    "values",
    [{"visible_m": 0.0}, {"visible_m": np.nan}, {"visible_margin_m": -0.1}, {"visible_deg": 181.0}],
)
def test_settings_are_checked(values: dict[str, float]) -> None:
    """A limit is above 0, an angle at most half a turn."""
    with pytest.raises(SettingError, match="visible-"):
        EvaluationParams(**values)  # type: ignore[arg-type]  # all of them are floats
