"""The blocks of profile robust: what is in front, and where single ranges lie."""

import math
from dataclasses import replace

import numpy as np
import pytest

from mpap_cli.features.scans.histograms import range_columns
from mpap_cli.features.scans.scan_features import ScanEmbedder
from mpap_cli.observations import Float32Array, ScanBlock, ScanGeometry
from mpap_cli.params import ScanParams, make_settings

NEATO = ScanGeometry(361, -math.pi, math.pi / 180, 0.02, 5.0)
ROBUST = make_settings("robust").scan


def point_of(params: ScanParams, bearing: int, range_m: float) -> Float32Array:
    """Return the point of a scan with one return, so many degrees left of straight ahead."""
    ranges = np.full((1, 361), 5.0, np.float32)
    ranges[0, bearing] = range_m
    block = ScanBlock(np.zeros(1, np.int64), ranges, NEATO)
    (point,) = ScanEmbedder(params, math.pi).transform(block).features
    return np.asarray(point)


def share_of(point: Float32Array, column: int) -> float:
    """Return the mass of a range beside its slack: 0.2 m divided by the range."""
    near, slack = point[column : column + 2].astype(np.float64) ** 2
    return float(near / (near + slack))


@pytest.mark.parametrize(
    ("bearing", "fov", "stretched_m"),
    [(0, "360", 0.3), (90, "360", 0.6), (180, "360", 0.9), (180, "180", 1.0)],
)
def test_what_lies_behind_counts_as_farther(bearing: int, fov: str, stretched_m: float) -> None:
    """Straight behind three times, beside twice; outside the field of view not at all."""
    found = point_of(replace(ROBUST, fov=fov), bearing, 0.3)

    assert share_of(found, 3) == pytest.approx(0.2 / stretched_m, rel=1e-5)


def test_the_columns_of_single_ranges_are_found() -> None:
    """Range and slack of ring and front, as far as they have a weight."""
    found = point_of(ROBUST, 0, 0.4)

    assert [share_of(found, column) for column in range_columns(ROBUST)] == pytest.approx([0.5] * 2)
    assert range_columns(ROBUST) == (0, 3)
    assert range_columns(replace(ROBUST, ring_weight=0.0)) == (0,)
    assert range_columns(replace(ROBUST, keep_scale=False)) == ()
    assert range_columns(make_settings("paper").scan) == ()
