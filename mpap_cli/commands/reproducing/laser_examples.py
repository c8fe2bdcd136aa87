"""Scans in and out of contact, with the image of the moment (figure 11)."""

from itertools import pairwise
from pathlib import Path

import numpy as np

from mpap_cli.commands.evaluating.observed import observe_logs
from mpap_cli.commands.inputs.log_images import frames_at
from mpap_cli.commands.inputs.progress import no_progress
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.laser_logs import PLACES, user_logs
from mpap_cli.features.images.image_decode import Image, decode_frame
from mpap_cli.logs.reader import expand_paths
from mpap_cli.observations import NS_PER_S, Float32Array, ObservedLog, Press, ScanGeometry
from mpap_cli.outputs.example_scans import ExampleScan, write_example_scans
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.simulation.scenario import simulate
from mpap_cli.simulation.settings import CameraParams, SimulationParams

_N_EACH = 2
_DURATION_S, _SHORT_S = 120.0, 40.0
_LEAST_NS = NS_PER_S // 5
_Scan = tuple[int, Float32Array, ScanGeometry]
"""Stamp, ranges, geometry."""


def draw_examples(bench: Bench) -> None:
    """Draw two scans far from any contact, and two in contact, of the first indoor log."""
    given = expand_paths(user_logs(bench, PLACES[0]))
    path = given[0] if given else _simulated(bench)
    selection = LogSelection(logs=(str(path),))
    with ResultsFolder(bench.scratch, "examples") as results:
        settings = bench.settings("paper")
        observed = observe_logs(selection, settings, results, 1, no_progress)
        log = observed.logs[0]
        moments = [(at, False) for at in _between(log)] + [(at, True) for at in _within(log)]
        scans = [_nearest_scan(log, at) for at, _ in moments]
    stamps = {scan[0] for scan in scans if scan is not None}
    images = _images(selection, log.name, stamps)
    examples = [
        _example(log, scan, images.get(scan[0]), in_contact=in_contact)
        for scan, (_, in_contact) in zip(scans, moments, strict=True)
        if scan is not None
    ]
    caption = (
        "Scans without (blue) and with a collision (vermilion): range over angle, from above, and "
        f"the image of the moment where there is one; {PLACES[0]}."
    )
    write_example_scans(bench.picture("figure-11", caption), examples)


def _simulated(bench: Bench) -> Path:
    """Write a short log of a robot with laser and camera; return its path."""
    path = bench.scratch / "examples.mcap"
    params = SimulationParams(
        world=PLACES[0],
        duration_s=_SHORT_S if bench.short else _DURATION_S,
        seed=bench.seeds[0],
        camera=CameraParams(size="320x240", hz=5.0),
    )
    simulate(path, params)
    return path


def _within(log: ObservedLog) -> list[int]:
    """Return the middles of the first presses that last."""
    lasting = [one for one in log.presses or () if one.end_ns - one.start_ns >= _LEAST_NS]
    return [_middle(one.start_ns, one.end_ns) for one in lasting[:_N_EACH]]


def _between(log: ObservedLog) -> list[int]:
    """Return the middles of the longest times without a press, in order."""
    ends = (Press(log.start_ns, log.start_ns), *(log.presses or ()), Press(log.end_ns, log.end_ns))
    gaps = [(first.end_ns, second.start_ns) for first, second in pairwise(ends)]
    longest = sorted(gaps, key=lambda gap: gap[0] - gap[1])[:_N_EACH]
    return sorted(_middle(*gap) for gap in longest)


def _middle(start_ns: int, end_ns: int) -> int:
    return (start_ns + end_ns) // 2


def _nearest_scan(log: ObservedLog, stamp_ns: int) -> _Scan | None:
    """Return the scan nearest to a moment, None of a log without any."""
    best: _Scan | None = None
    for block in log.blocks():
        index = int(np.abs(block.stamps_ns - stamp_ns).argmin())
        at = int(block.stamps_ns[index])
        if best is None or abs(at - stamp_ns) < abs(best[0] - stamp_ns):
            best = at, block.ranges[index].copy(), block.geometry
    return best


def _images(selection: LogSelection, name: str, stamps_ns: set[int]) -> dict[int, Image]:
    """Return the images of these moments, where there are any."""
    found: dict[int, Image] = {}
    for log, stamp_ns, frame in frames_at(selection, stamps_ns):
        image = decode_frame(frame) if log == name else None
        if image is not None:
            found[stamp_ns] = image
    return found


def _example(
    log: ObservedLog, scan: _Scan, image: Image | None, *, in_contact: bool
) -> ExampleScan:
    """Put one example together."""
    stamp_ns, ranges, geometry = scan
    return ExampleScan(
        time_s=(stamp_ns - log.start_ns) / NS_PER_S,
        in_contact=in_contact,
        ranges=ranges,
        geometry=geometry,
        forward_rad=log.forward_rad,
        range_max=log.range_max,
        image=image,
    )
