"""Bins by angle: the paper's for the paper's scanner, sound ones for every other."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mpap_cli.features.scans.scan_bins import BinLayout, beam_bearings, lay_out_bins
from mpap_cli.observations import ScanGeometry
from mpap_cli.params import ScanParams

DEGREE = math.pi / 180


def geometry_of(n_beams: int, first_degrees: float, step_degrees: float) -> ScanGeometry:
    """Return a geometry with angles rounded to float32, as messages carry them."""
    first = float(np.float32(first_degrees * DEGREE))
    return ScanGeometry(n_beams, first, float(np.float32(step_degrees * DEGREE)), 0.05, 8.0)


def paper(bins: int, fov: str = "profile") -> ScanParams:
    """Return settings of a feature of the paper."""
    return ScanParams(feature="global-diff", bins=bins, fov=fov)


def beams_of(layout: BinLayout, geometry: ScanGeometry) -> list[list[int]]:
    """Return the beams of every bin by their index in the message."""
    found = [[k % layout.n_turn for k in range(*run)] for run in layout.runs[:-1]]
    if layout.clockwise:
        return [[geometry.n_beams - 1 - k for k in beams] for beams in found]
    return found


@pytest.mark.parametrize(("bins", "beams"), [(6, 30), (12, 15)])
@pytest.mark.parametrize("fov", ["profile", "180", "-90,90"])
@pytest.mark.parametrize("n_beams", [180, 181])
def test_the_papers_scanner_has_the_papers_bins(
    bins: int, beams: int, fov: str, n_beams: int
) -> None:
    """180 beams make 6 x 30 or 12 x 15; a 181st beam falls out."""
    geometry = geometry_of(n_beams, -90, 1)

    layout = lay_out_bins(geometry, 0.0, paper(bins, fov))

    wanted = np.arange(180).reshape(bins, beams).tolist()
    assert layout.usable
    assert beams_of(layout, geometry) == wanted


def test_a_scan_of_at_most_200_degrees_is_seen_whole() -> None:
    """A scanner that counts from 0 to 180 is not cut at 90, wherever forward is."""
    geometry = geometry_of(181, 0, 1)

    layouts = [lay_out_bins(geometry, forward, paper(6)) for forward in (0.0, 1.0, math.pi)]

    for layout in layouts:
        assert beams_of(layout, geometry) == np.arange(180).reshape(6, 30).tolist()


def test_a_wider_scan_is_cut_to_180_degrees_about_forward() -> None:
    """Of 270 degrees the paper's features see those within 90 degrees of forward."""
    geometry = geometry_of(541, -135, 0.5)

    layout = lay_out_bins(geometry, 0.0, paper(6))

    assert beams_of(layout, geometry) == np.arange(90, 450).reshape(6, 60).tolist()


def test_a_neato_looks_ahead_with_its_first_and_last_beams() -> None:
    """361 beams from -pi, forward pi: bins cross the wrap in order; beam 360 falls out."""
    geometry = ScanGeometry(361, -3.1415927410125732, 0.01745329238474369, 0.02, 5.0)

    front = lay_out_bins(geometry, math.pi, paper(6))
    around = lay_out_bins(geometry, math.pi, ScanParams())

    assert beams_of(front, geometry)[0] == list(range(270, 300))
    assert beams_of(front, geometry)[3] == list(range(30))
    assert beams_of(around, geometry)[0] == list(range(180, 210))
    assert beams_of(around, geometry)[6] == list(range(30))
    assert beams_of(lay_out_bins(geometry, math.pi, paper(2, "40")), geometry) == [
        list(range(340, 360)),
        list(range(20)),
    ]


def test_a_bin_across_the_wrap_keeps_the_order_of_angles() -> None:
    """The beams of a bin straight ahead go from right to left through the wrap."""
    geometry = geometry_of(360, 0, 1)

    layout = lay_out_bins(geometry, 0.0, paper(1, "20"))

    assert beams_of(layout, geometry) == [[*range(350, 360), *range(10)]]


def test_a_clockwise_scanner_has_the_bins_of_its_mirror() -> None:
    """With a negative increment the same angles lie in the same bins."""
    rising = geometry_of(360, -180, 1)
    falling = geometry_of(360, 179, -1)

    for forward in (0.0, 1.234, math.pi):
        mirrored = beams_of(lay_out_bins(falling, forward, paper(12, "360")), falling)
        wanted = beams_of(lay_out_bins(rising, forward, paper(12, "360")), rising)
        assert [[359 - k for k in beams] for beams in mirrored] == wanted


@st.composite
def scanners(draw: st.DrawFn) -> tuple[ScanGeometry, float]:
    """Draw a scanner of at most one turn, and where forward is."""
    n_beams = draw(st.integers(60, 400))
    step = draw(st.floats(0.3, 1.0)) * math.tau / n_beams * draw(st.sampled_from([-1, 1]))
    geometry = ScanGeometry(n_beams, draw(st.floats(-4, 7)), step, 0.05, 8.0)
    return geometry, draw(st.floats(-4, 4))


@given(
    scanner=scanners(),
    start=st.integers(-180, 180),
    width=st.integers(60, 360),
    bins=st.integers(1, 12),
)
def test_every_beam_lies_in_the_bin_of_its_angle(
    scanner: tuple[ScanGeometry, float], start: int, width: int, bins: int
) -> None:
    """Bin j holds exactly the beams with FROM + j W / b <= a < FROM + (j + 1) W / b."""
    geometry, forward = scanner
    layout = lay_out_bins(geometry, forward, paper(bins, f"{start},{start + width}"))
    assume(layout.usable)

    found = beams_of(layout, geometry)

    step, n_beams = geometry.angle_increment, geometry.n_beams
    angles = geometry.angle_min + step * np.arange(n_beams) - forward - start * DEGREE
    offsets = (angles + 1e-3 * abs(step)) % math.tau
    position = offsets / (width * DEGREE / bins)
    at_edge = set(np.flatnonzero(np.abs(position - np.round(position)) < 0.01).tolist())
    for j, beams in enumerate(found):
        inside = set(np.flatnonzero(np.floor(position) == j).tolist())
        left_out = not beams and len(inside) < 2
        assert left_out or set(beams) ^ inside <= at_edge
        assert np.all(np.diff(offsets[beams]) > 0)


def test_sectors_behind_a_half_round_scanner_are_outside() -> None:
    """Of 12 sectors all round a 180 degree laser fills 6; its 181st beam makes no sector."""
    for n_beams in (180, 181):
        layout = lay_out_bins(geometry_of(n_beams, -90, 1), 0.0, ScanParams())

        sizes = (layout.runs[:-1, 1] - layout.runs[:-1, 0]).tolist()
        assert layout.usable
        assert sizes == [0, 0, 0, 30, 30, 30, 30, 30, 30, 0, 0, 0]
        assert layout.n_outside == 6


def test_a_sector_that_is_partly_seen_uses_its_beams() -> None:
    """A 270 degree laser sees half of the sectors beside its blind quarter."""
    layout = lay_out_bins(geometry_of(270, -135, 1), 0.0, ScanParams())

    sizes = (layout.runs[:-1, 1] - layout.runs[:-1, 0]).tolist()
    assert sizes == [0, 15, 30, 30, 30, 30, 30, 30, 30, 30, 15, 0]


@pytest.mark.parametrize(
    ("geometry", "params"),
    [
        (geometry_of(10, -90, 20), paper(12)),
        (geometry_of(180, -90, 1), paper(180)),
        (geometry_of(180, -90, 1), paper(6, "100,170")),
        (geometry_of(1, 0, 1), paper(1)),
        (geometry_of(0, 0, 1), paper(1)),
        (ScanGeometry(180, 0.0, 0.0, 0.05, 8.0), paper(6)),
        (ScanGeometry(180, math.nan, 0.1, 0.05, 8.0), paper(6)),
        (ScanGeometry(180, 0.0, math.inf, 0.05, 8.0), paper(6)),
    ],
    ids=["sparse", "too many bins", "looks away", "one", "none", "flat", "nan", "inf"],
)
def test_a_bin_with_fewer_than_two_beams_is_unusable(
    geometry: ScanGeometry, params: ScanParams
) -> None:
    """Too few beams in a bin that should hold some, or no angles at all."""
    assert not lay_out_bins(geometry, 0.0, params).usable


def test_ahead_is_within_ninety_degrees_of_forward() -> None:
    """Both beams at exactly 90 degrees belong to what is ahead, also across the wrap."""
    neato = geometry_of(361, -180, 1)
    half = geometry_of(181, -90, 1)

    assert lay_out_bins(neato, math.pi, ScanParams()).runs[-1].tolist() == [270, 451]
    assert lay_out_bins(half, 0.0, ScanParams()).runs[-1].tolist() == [0, 181]
    assert lay_out_bins(half, math.pi, ScanParams()).runs[-1].tolist() == [180, 182]


def test_bearings_are_turned_to_forward() -> None:
    """Beam 0 of a Neato, at -pi, is straight ahead when forward is pi."""
    bearings = beam_bearings(geometry_of(361, -180, 1), math.pi)

    assert abs(bearings[0]) < 1e-6
    assert bearings[90] == pytest.approx(math.pi / 2, abs=1e-5)
    assert bearings[270] == pytest.approx(-math.pi / 2, abs=1e-5)
