"""Way and laser returns of a robot that drives in a square room."""

import numpy as np
import pytest

from mpap_cli.observations import NS_PER_S, Float64Array, PoseBlock, ScanBlock, ScanGeometry
from mpap_cli.outputs import map_sketch
from mpap_cli.outputs.map_sketch import MapSketch
from mpap_cli.params import ScanParams

FORWARD = 0.7
GEOMETRY = ScanGeometry(360, -np.pi, np.pi / 180, 0.05, 20.0)
WALL_M = 3.0


def poses_of(seconds: Float64Array) -> PoseBlock:
    """Drive in circles of 1 m around the middle of the room, one turn in 20 s."""
    angle = seconds * 2 * np.pi / 20
    heading = np.remainder(angle + np.pi / 2 + np.pi, 2 * np.pi) - np.pi
    poses = np.column_stack((np.cos(angle), np.sin(angle), heading))
    return PoseBlock((seconds * NS_PER_S).astype(np.int64), poses)


def scans_of(seconds: Float64Array) -> ScanBlock:
    """Measure the walls of a square room, 3 m from its middle, from these places."""
    poses = poses_of(seconds).poses
    beams = GEOMETRY.angle_min + GEOMETRY.angle_increment * np.arange(GEOMETRY.n_beams)
    angles = poses[:, 2:] + beams - FORWARD
    with np.errstate(divide="ignore"):
        to_x = (np.sign(np.cos(angles)) * WALL_M - poses[:, :1]) / np.cos(angles)
        to_y = (np.sign(np.sin(angles)) * WALL_M - poses[:, 1:2]) / np.sin(angles)
    ranges = np.minimum(to_x, to_y).astype(np.float32)
    ranges[:, ::50] = np.inf
    return ScanBlock((seconds * NS_PER_S).astype(np.int64), ranges, GEOMETRY)


def driven(n_seconds: int = 20) -> MapSketch:
    """Let a sketch see the room, second by second; odometry at 100 Hz, scans at 5 Hz."""
    sketch = MapSketch(ScanParams(), FORWARD)
    for second in range(n_seconds):
        sketch.add_poses(poses_of(second + np.arange(100) / 100))
        sketch.add_scans(scans_of(second + np.arange(5) / 5 + 0.01))
    return sketch


def test_returns_lie_on_the_walls() -> None:
    """To within a cell, from wherever and whichever way the robot looked."""
    returns = driven().returns

    off_m = np.abs(np.abs(returns).max(axis=1) - WALL_M)
    assert off_m.max() < 0.06
    assert len(returns) > 400


def test_way_is_kept_in_steps() -> None:
    """From the first pose on, about every 2 cm of way and turn."""
    way = driven().way

    assert way[0] == pytest.approx([1, 0, np.pi / 2])
    assert np.hypot(way[:, 0], way[:, 1]) == pytest.approx(1.0)
    steps = np.hypot(*np.diff(way[:, :2], axis=0).T)
    assert steps.max() < 0.05
    assert 300 < len(way) < 500


def test_robot_that_stands_still_fills_no_memory() -> None:
    """Its way is one pose, its returns are the cells that it sees."""
    sketch = MapSketch(ScanParams(), FORWARD)
    still = poses_of(np.zeros(100))

    for second in range(50):
        stamps_ns = second * NS_PER_S + np.arange(100) * (NS_PER_S // 100)
        sketch.add_poses(PoseBlock(stamps_ns, still.poses))
        sketch.add_scans(scans_of(np.zeros(1)))

    assert len(sketch.way) == 1
    assert len(sketch.returns) <= 360


def test_places_are_between_the_poses() -> None:
    """To within a step, until shortly after the last pose; else not known."""
    sketch = driven(10)
    seconds = np.array([0.0, 3.3, 9.96, 10.05, 11.0])
    true = poses_of(seconds).poses

    found = sketch.places((seconds * NS_PER_S).astype(np.int64))

    assert np.abs(found[:4, :2] - true[:4, :2]).max() < 0.05
    assert np.isnan(found[4]).all()


def test_long_log_grows_coarser(monkeypatch: pytest.MonkeyPatch) -> None:
    """Way and returns stay below their most, and stay true."""
    monkeypatch.setattr(map_sketch, "MOST_POSES", 100)
    monkeypatch.setattr(map_sketch, "MOST_CELLS", 150)

    sketch = driven(40)

    way, returns = sketch.way, sketch.returns
    assert 50 <= len(way) <= 100
    assert 50 <= len(returns) <= 150
    assert np.abs(np.abs(returns).max(axis=1) - WALL_M).max() < 0.5


def test_scans_without_odometry_are_left_out() -> None:
    """Nobody knows where they were taken; nothing at all is an empty map."""
    sketch = MapSketch(ScanParams(), FORWARD)

    sketch.add_scans(scans_of(np.arange(5.0)))
    sketch.add_poses(PoseBlock(np.zeros(0, np.int64), np.zeros((0, 3))))
    alone = sketch.returns.shape
    sketch.add_poses(poses_of(np.array([0.0])))
    sketch.add_scans(scans_of(np.array([5.0, 6.0])))

    assert alone == (0, 2)
    assert sketch.returns.shape == (0, 2)
    assert np.isnan(MapSketch(ScanParams(), 0.0).places(np.array([0]))).all()


def test_input_is_left_alone() -> None:
    """Neither blocks nor what is returned share memory with the sketch."""
    sketch = driven(1)
    before = sketch.way
    poses = poses_of(np.array([1.0, 1.05]))
    kept = poses.poses.copy()

    sketch.add_poses(poses)
    sketch.way[:] = 99
    poses.poses[:] = 77

    assert sketch.way[: len(before)].tolist() == before.tolist()
    assert sketch.way[len(before) :].max() < 10
    assert kept.max() < 10
