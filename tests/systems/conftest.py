"""A robot that drives up to a wall and hits it, for the tests of whole models."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from mpap_cli.observations import (
    NS_PER_S,
    Batch,
    Bump,
    FeatureBlock,
    FloatArray,
    Frame,
    PoseBlock,
    Press,
    ScanBlock,
    ScanGeometry,
)
from mpap_cli.params import Settings
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.labelling import LogStart

GEOMETRY = ScanGeometry(60, -np.pi, 2 * np.pi / 60, range_min=0.05, range_max=5.0)
SCAN_NS = NS_PER_S // 5


def _drive(seconds: int, seed: int) -> tuple[ScanBlock, tuple[Press, ...]]:
    """Return scans of a robot that drives up to a wall every twelve seconds and hits it."""
    random = np.random.default_rng(seed)
    n = seconds * 5
    stamps_ns = np.arange(n, dtype=np.int64) * SCAN_NS + 10 * NS_PER_S
    phase = (np.arange(n) * 0.2) % 12
    ahead = np.where(phase < 8, 2.6 - 0.3 * phase, 0.2 + 0.6 * (phase - 8))
    angles = GEOMETRY.angle_min + GEOMETRY.angle_increment * np.arange(60)
    facing = np.cos(angles)
    wall = ahead[:, None] / np.maximum(facing, 0.2)
    ranges = np.where(facing > 0.2, wall, 2.5) + random.normal(0, 0.02, size=(n, 60))
    presses = tuple(
        Press(int(start), int(start) + 2 * NS_PER_S)
        for start in stamps_ns[0] + (np.arange(seconds // 12) * 12 + 7.5) * NS_PER_S
    )
    return ScanBlock(stamps_ns, ranges.astype(np.float32), GEOMETRY), presses


def _part_of(block: ScanBlock, start: int, stop: int) -> ScanBlock:
    """Return some scans of a block."""
    return replace(block, stamps_ns=block.stamps_ns[start:stop], ranges=block.ranges[start:stop])


def _bumps_of(presses: tuple[Press, ...]) -> list[Bump]:
    """Return the states of a level topic."""
    bumps = [Bump(0, "", pressed=False)]
    for press in presses:
        bumps += [Bump(press.start_ns, "", pressed=True), Bump(press.end_ns, "", pressed=False)]
    return bumps


def _batches(block: ScanBlock, presses: tuple[Press, ...], size: int) -> list[Batch]:
    """Cut a log into batches."""
    bumps, made, last_ns = _bumps_of(presses), [], -1
    for start in range(0, block.stamps_ns.size, size):
        part = _part_of(block, start, start + size)
        until_ns = int(part.stamps_ns[-1])
        inside = tuple(bump for bump in bumps if last_ns < bump.stamp_ns <= until_ns)
        made.append(Batch(until_ns, (part,), inside))
        last_ns = until_ns
    return made


def _replayed(
    settings: Settings, *, size: int = 64, online: bool = False, name: str = "a.bag"
) -> CollisionModel:
    """Return a model that learnt one log."""
    block, presses = _drive(240, seed=1)
    model = CollisionModel(settings, online=online)
    model.begin_log(LogStart(name=name, start_ns=0, bump_kind="level", bump_source="bumper"))
    for batch in _batches(block, presses, size):
        model.observe(batch)
    model.end_log(int(block.stamps_ns[-1]))
    return model


def _features_of(settings: Settings, block: ScanBlock) -> FeatureBlock:
    """Return the features that a model of these settings makes."""
    model = CollisionModel(settings)
    model.begin_log(LogStart(name="", start_ns=0))
    return model.embed(block)


@pytest.fixture
def drive() -> Callable[[int, int], tuple[ScanBlock, tuple[Press, ...]]]:
    """Return what makes the scans and presses of so many seconds from a seed."""
    return _drive


@pytest.fixture
def part_of() -> Callable[[ScanBlock, int, int], ScanBlock]:
    """Return what takes some scans out of a block."""
    return _part_of


@pytest.fixture
def batches() -> Callable[[ScanBlock, tuple[Press, ...], int], list[Batch]]:
    """Return what cuts a log into batches of so many scans."""
    return _batches


@pytest.fixture
def replayed() -> Callable[..., CollisionModel]:
    """Return what learns four minutes of the robot with given settings."""
    return _replayed


@pytest.fixture
def features_of() -> Callable[[Settings, ScanBlock], FeatureBlock]:
    """Return what makes the features of scans under given settings."""
    return _features_of


@dataclass(frozen=True, slots=True, eq=False)
class CameraDrive:
    """A log of a robot with a camera: what :class:`AppearanceModel` is replayed from."""

    frames: tuple[Frame, ...]
    presses: tuple[Press, ...]
    poses: PoseBlock

    @property
    def end_ns(self) -> int:
        """Stamp of the last image."""
        return self.frames[-1].stamp_ns

    def batches(self, size: int) -> list[Batch]:
        """Cut the log into batches of so many images."""
        bumps, made, last_ns = _bumps_of(self.presses), list[Batch](), -1
        for start in range(0, len(self.frames), size):
            frames = self.frames[start : start + size]
            until_ns = frames[-1].stamp_ns
            inside = tuple(bump for bump in bumps if last_ns < bump.stamp_ns <= until_ns)
            at = (last_ns < self.poses.stamps_ns) & (self.poses.stamps_ns <= until_ns)
            poses = PoseBlock(self.poses.stamps_ns[at], self.poses.poses[at])
            made.append(Batch(until_ns, (), inside, frames, poses))
            last_ns = until_ns
        return made


def _surface(random: np.random.Generator, color: tuple[int, int, int], period: int) -> FloatArray:
    """Return a picture of a surface with stripes, a little different each time."""
    stripes = 25 * np.sin(2 * np.pi * (np.arange(96) + random.integers(period)) / period)
    noise = random.normal(0, 6, size=(72, 96, 1))
    picture: FloatArray = np.array(color) + stripes[:, None] + noise
    return picture


def _camera_drive(seconds: int, seed: int) -> CameraDrive:
    """Return images of a robot that drives over a floor up to a wall and hits it."""
    random = np.random.default_rng(seed)
    stamps_ns = np.arange(seconds * 5, dtype=np.int64) * SCAN_NS + 10 * NS_PER_S
    phase = (np.arange(stamps_ns.size) * 0.2) % 12
    ahead = np.where(phase < 8, 2.4 - 0.3 * phase, 0.6 * (phase - 8)).clip(0, 2.4)
    frames = []
    for stamp_ns, away in zip(stamps_ns.tolist(), ahead, strict=True):
        picture = _surface(random, (60, 110, 160), 12)
        horizon = round(72 * (1 - 0.3 * away))
        wall = _surface(random, (170, 90, 60), 5)
        picture[:horizon] = wall[:horizon]
        pixels = picture.clip(0, 255).astype(np.uint8)
        frames.append(Frame(stamp_ns, "bgr8", 96, 72, 288, pixels.tobytes()))
    presses = tuple(
        Press(int(start), int(start) + NS_PER_S)
        for start in stamps_ns[0] + (np.arange(seconds // 12) * 12 + 8) * NS_PER_S
    )
    poses = np.stack([-ahead, 0 * ahead, 0 * ahead], axis=1)
    return CameraDrive(tuple(frames), presses, PoseBlock(stamps_ns, poses))


def _seen(
    settings: Settings, *, size: int = 64, seed: int = 1, model: AppearanceModel | None = None
) -> AppearanceModel:
    """Return a model that learnt a minute and a half of the robot."""
    drive = _camera_drive(96, seed)
    model = model or AppearanceModel(settings)
    name = f"{seed}.bag"
    model.begin_log(LogStart(name=name, start_ns=0, bump_kind="level", bump_source="bumper"))
    for batch in drive.batches(size):
        model.observe(batch)
    model.end_log(drive.end_ns)
    return model


@pytest.fixture
def camera_drive() -> Callable[[int, int], CameraDrive]:
    """Return what makes the log of so many seconds with a camera from a seed."""
    return _camera_drive


@pytest.fixture
def seen() -> Callable[..., AppearanceModel]:
    """Return what learns a minute and a half of the robot with a camera."""
    return _seen
