"""Baselines separate what can be separated and stand degenerate training scans."""

import numpy as np
import pytest

from mpap_cli.evaluation.baselines import BASELINES, MAX_TRAIN, ReadOut, training_sample
from mpap_cli.observations import BoolArray, Float32Array

READ_OUT = ReadOut(theta=0.1, neighbors=20, prior_counts=2.0, n_centers=30, seed=0)


def two_kinds(n: int, seed: int, dims: int) -> tuple[Float32Array, BoolArray]:
    """Make unit rows about two directions, the second positive; column 0 tells them apart."""
    generator = np.random.default_rng(seed)
    positive = generator.random(n) < 0.3
    rows = generator.random((n, dims)) * 0.2
    rows[:, 0] += np.where(positive, 0.0, 1.0)
    rows[:, -1] += np.where(positive, 1.0, 0.0)
    if dims > 1:
        rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    else:
        rows = np.where(positive, 0.2, 2.0)[:, None] + generator.random((n, 1)) * 0.1
    return rows.astype(np.float32), positive


@pytest.mark.parametrize("name", BASELINES)
def test_baseline_finds_an_easy_rule(name: str) -> None:
    """New scans of both kinds are ordered right; scores of one seed are the same bytes."""
    dims = 1 if name.startswith("nearest-range") else 6
    rows, labels = two_kinds(120, 1, dims)
    tested, truth = two_kinds(60, 2, dims)

    score, p = BASELINES[name].fit(rows, labels, READ_OUT)(tested)
    again, _ = BASELINES[name].fit(rows, labels, READ_OUT)(tested)

    assert score[truth].min() > score[~truth].max()
    assert np.all((p >= 0) & (p <= 1))
    assert score.tobytes() == again.tobytes()


@pytest.mark.parametrize("name", BASELINES)
def test_baseline_stands_scans_that_are_all_alike(name: str) -> None:
    """Equal scans with different labels get one probability, near the base rate."""
    dims = 1 if name.startswith("nearest-range") else 4
    rows = np.full((12, dims), 0.5, dtype=np.float32)
    labels = np.arange(12) % 3 == 0

    score, p = BASELINES[name].fit(rows, labels, READ_OUT)(rows)

    assert np.unique(score).size == 1
    assert p == pytest.approx(1 / 3, abs=0.05)


def test_kernel_read_out_by_hand() -> None:
    """One scan at distance 0, one far away: (1 + 2 * base) / (1 + 2)."""
    rows = np.array([[1.0, 0.0], [0.0, 1.0]], dtype=np.float32)
    labels = np.array([True, False])

    _, p = BASELINES["knn-scans"].fit(rows, labels, READ_OUT)(rows)

    assert p == pytest.approx([2 / 3, 1 / 3])


def test_long_logs_are_sampled() -> None:
    """At most MAX_TRAIN scans are fitted, the same ones for one seed."""
    labels = np.zeros(MAX_TRAIN + 5, dtype=np.bool_)

    chosen = training_sample(labels, 3)

    assert chosen.sum() == MAX_TRAIN
    assert np.array_equal(chosen, training_sample(labels, 3))
    assert training_sample(labels[:10], 3).all()
