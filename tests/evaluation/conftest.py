"""A robot that drives up to a wall, bumps into it and backs off, again and again."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
import pytest

from mpap_cli.observations import NS_PER_S, Batch, ObservedLog, Press, ScanBlock, ScanGeometry
from mpap_cli.params import Settings, make_settings
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.labelling import LogStart

GEOMETRY = ScanGeometry(72, -np.pi, np.pi / 36, 0.02, 5.0)
CYCLE_S = 15
RATE = 5

MakeLog = Callable[..., ObservedLog]
LearnLogs = Callable[[Settings, Sequence[ObservedLog]], CollisionModel]


def _blocks(n_cycles: int, seed: int, start_ns: int) -> list[ScanBlock]:
    """Make scans: the wall ahead comes nearer from 3 m to 0.25 m, then is far again."""
    generator = np.random.default_rng(seed)
    n_scans = n_cycles * CYCLE_S * RATE
    phase = (np.arange(n_scans) / RATE) % CYCLE_S
    ahead = np.clip(3.0 - phase * 0.275, 0.25, 3.0)
    ahead = np.where(phase > 11, 0.25 + (phase - 11) * 0.7, ahead)
    angles = GEOMETRY.angle_min + GEOMETRY.angle_increment * np.arange(GEOMETRY.n_beams)
    wall = ahead[:, None] / np.maximum(np.cos(angles), 0.2)
    ranges = np.where(np.cos(angles) > 0.2, wall, 4.0) + generator.normal(0, 0.03, wall.shape)
    stamps_ns = start_ns + np.arange(n_scans) * (NS_PER_S // RATE)
    clean = np.clip(ranges, 0.05, 4.9).astype(np.float32)
    parts = np.array_split(np.arange(n_scans), max(1, n_scans // 64))
    return [ScanBlock(stamps_ns[part], clean[part], GEOMETRY) for part in parts]


@pytest.fixture
def make_log() -> MakeLog:
    """Return a function that makes a log of cycles of 15 s with a press from 10 s to 11.4 s."""

    def make(
        name: str = "log", n_cycles: int = 4, seed: int = 0, *, bumper: bool = True
    ) -> ObservedLog:
        start_ns = 1_700_000_000 * NS_PER_S + seed * 10_000 * NS_PER_S
        blocks = _blocks(n_cycles, seed, start_ns)
        starts = [start_ns + int((CYCLE_S * i + 10) * NS_PER_S) for i in range(n_cycles)]
        presses = tuple(Press(at, at + 1_400_000_000) for at in starts)

        def again() -> Iterator[ScanBlock]:
            return iter(blocks)

        return ObservedLog(
            name=name,
            path=f"logs/{name}",
            start_ns=start_ns,
            end_ns=start_ns + n_cycles * CYCLE_S * NS_PER_S,
            forward_rad=0.0,
            range_max=None,
            presses=presses if bumper else None,
            bump_source="bumper /bump" if bumper else "none",
            blocks=again,
        )

    return make


@pytest.fixture
def settings() -> Settings:
    """Return the default settings with few resamples."""
    return make_settings("robust", {"resamples": "50"})


@pytest.fixture
def learn_logs() -> LearnLogs:
    """Return a function that replays logs into a model, block by block."""

    def learn(settings: Settings, logs: Sequence[ObservedLog]) -> CollisionModel:
        model = CollisionModel(settings)
        for log in logs:
            model.begin_log(LogStart.of(log))
            for block in log.blocks():
                model.observe(Batch(int(block.stamps_ns[-1]), (block,), ()))
            model.end_log(log.end_ns)
        model.finish()
        return model

    return learn
