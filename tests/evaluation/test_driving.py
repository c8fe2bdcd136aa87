"""Ranges ahead and motion at given moments."""

import numpy as np
import pytest

from mpap_cli.errors import UsageError
from mpap_cli.evaluation.driving import (
    drives_ahead,
    nearest_straight_ahead,
    returned_ranges,
    values_at,
)
from mpap_cli.observations import NS_PER_S, Float64Array, PoseBlock, ScanBlock, ScanGeometry
from mpap_cli.params import ScanParams

DEGREES = ScanGeometry(360, -np.pi, np.pi / 180, 0.1, 8.0)


def one_near(bearing_deg: int, range_m: float = 0.5, geometry: ScanGeometry = DEGREES) -> ScanBlock:
    """Make a scan of 3 m all round with one nearer beam."""
    ranges = np.full((1, 360), 3.0, np.float32)
    ranges[0, bearing_deg + 180] = range_m
    return ScanBlock(np.array([0]), ranges, geometry)


@pytest.mark.parametrize(
    ("bearing_deg", "nearest_m"), [(0, 0.5), (19, 0.5), (-19, 0.5), (22, 3.0), (-90, 3.0)]
)
def test_nearest_ahead_looks_twenty_degrees_to_each_side(
    bearing_deg: int, nearest_m: float
) -> None:
    """What lies beside is not ahead."""
    found = nearest_straight_ahead(one_near(bearing_deg), ScanParams(), 0.0)

    assert found.tolist() == [nearest_m]


def test_ahead_is_where_the_robot_drives() -> None:
    """The direction of travel is given in the frame of the scanner."""
    found = nearest_straight_ahead(one_near(90), ScanParams(), np.pi / 2)

    assert found.tolist() == [0.5]


@pytest.mark.parametrize("nothing", [np.inf, np.nan, 0.0, 9.0])
def test_no_return_ahead_is_no_distance(nothing: float) -> None:
    """Whatever a driver writes for it, also if such beams count as range_max or drop out."""
    block = ScanBlock(np.array([0]), np.full((1, 360), nothing, np.float32), DEGREES)

    for way in ("max", "drop"):
        found = nearest_straight_ahead(block, ScanParams(no_return=way), 0.0)
        assert np.isnan(found).all()
        assert np.isnan(returned_ranges(block, ScanParams())).all()


def test_scanner_without_maximum_range_needs_one() -> None:
    """The maximum found elsewhere is taken; without any there is an error."""
    blind = ScanGeometry(360, -np.pi, np.pi / 180, 0.1, 0.0)
    block = one_near(0, geometry=blind)

    assert nearest_straight_ahead(block, ScanParams(), 0.0, range_max=6.0).tolist() == [0.5]
    with pytest.raises(UsageError, match="--max-range"):
        nearest_straight_ahead(block, ScanParams(), 0.0)


def test_value_is_the_nearest_in_time() -> None:
    """Within 0.2 s, of two equally near the earlier."""
    stamps_ns = np.array([0, 100, 240, 250, 400, 401]) * (NS_PER_S // 1000)
    of_ns = np.array([100, 300, 600]) * (NS_PER_S // 1000)

    found = values_at(stamps_ns, of_ns, np.array([1.0, 3.0, 6.0]))

    assert found.tolist() == [1.0, 1.0, 3.0, 3.0, 3.0, 3.0]
    assert np.isnan(values_at(np.array([801_000_000]), of_ns, np.array([1.0, 3.0, 6.0]))).all()
    assert np.isnan(values_at(stamps_ns, of_ns[:0], np.zeros(0))).all()


def drive(speed_mps: float, turn_radps: float = 0.0, heading: float = 0.0) -> PoseBlock:
    """Drive for four seconds, odometry at 20 Hz."""
    seconds = np.arange(80) / 20
    headings = heading + turn_radps * seconds
    way = np.stack((np.cos(headings), np.sin(headings)), axis=1) * speed_mps / 20
    places: Float64Array = np.cumsum(way, axis=0)
    wrapped = np.remainder(headings + np.pi, 2 * np.pi) - np.pi
    return PoseBlock((seconds * NS_PER_S).astype(np.int64), np.column_stack((places, wrapped)))


@pytest.mark.parametrize(
    ("poses", "driving"),
    [
        (drive(0.3), True),
        (drive(0.3, heading=2.5), True),
        (drive(0.3, turn_radps=1.0, heading=3.0), True),
        (drive(-0.3), False),
        (drive(0.0, turn_radps=1.5), False),
        (drive(0.05), False),
    ],
)
def test_driving_is_getting_on_in_the_direction_of_the_heading(
    poses: PoseBlock, driving: bool
) -> None:
    """Backing off, turning in place and creeping are none, whatever the heading."""
    moments = np.array([1, 2, 3]) * NS_PER_S

    assert drives_ahead(moments, poses).tolist() == [driving] * 3


def test_robot_does_not_drive_where_there_is_no_odometry() -> None:
    """Before its first half second, after its last pose, and without two poses."""
    poses = drive(0.3)
    moments = np.array([0.2, 1.0, 60.0]) * NS_PER_S

    found = drives_ahead(moments.astype(np.int64), poses)
    alone = drives_ahead(moments.astype(np.int64), PoseBlock(poses.stamps_ns[:1], poses.poses[:1]))

    assert found.tolist() == [False, True, False]
    assert not alone.any()
