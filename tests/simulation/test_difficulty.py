"""Simulated contacts are neither trivial nor hopeless to tell from one scan."""

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sklearn.metrics import roc_auc_score

from mpap_cli.logs.reader import open_log
from mpap_cli.simulation.scenario import SCAN_TOPIC, simulate
from mpap_cli.simulation.settings import PLACES, SimulationParams


@pytest.mark.slow
@pytest.mark.parametrize(("place", "seed"), list(itertools.product(PLACES, range(10))))
def test_nearest_range_alone_is_a_fair_but_not_a_perfect_guess(
    tmp_path: Path, place: str, seed: int
) -> None:
    """Over ten minutes the nearest range ahead has a contact AUC from 0.6 to 0.97."""
    params = SimulationParams(world=place, seed=seed, duration_s=600, compression="none")

    log = simulate(tmp_path / "log.mcap", params)

    nearest, truth = [], []
    with open_log(log.path) as reader:
        for message in reader.messages([SCAN_TOPIC]):
            scan: Any = reader.decode(message)
            nearest.append(np.where(scan.ranges <= scan.range_max, scan.ranges, 8.0).min())
            stamp = message.stamp_ns
            truth.append(any(c.start_ns <= stamp < c.end_ns for c in log.contacts))
    assert 0.6 <= roc_auc_score(truth, -np.array(nearest)) <= 0.97
