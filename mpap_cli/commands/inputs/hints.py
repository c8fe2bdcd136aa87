"""What a user should know of a log or model, said once: labels, directions, parameters."""

import logging
import math
from collections.abc import Sequence

import numpy as np

from mpap_cli.commands.inputs.sources import Source
from mpap_cli.features.scans.scan_features import ScanEmbedder
from mpap_cli.observations import Float64Array, ObservedLog, Press
from mpap_cli.outputs.text_table import count
from mpap_cli.params import ScanParams
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.collision import CollisionModel

LOGGER = logging.getLogger(__name__)
OFF_COURSE_RAD = math.radians(60)
SAME_SIDE = 0.5  # length of the mean bearing: 1 if all agree, 0 if they point anywhere
HEADING_STEP_DEG = 5


def tell_of_presses(
    source: Source, presses: tuple[Press, ...] | None, scan_span: tuple[int, int] | None
) -> None:
    """Say where labels are missing, and which option would give some.

    Parameters
    ----------
    source : Source
        The log that was read.
    presses : tuple of Press or None
        None without a bumper.
    scan_span : tuple of int or None
        First and last stamp of the scans; None without scans.
    """
    name = source.name
    first_ns, last_ns = scan_span or (0, -1)
    if presses is None:
        LOGGER.warning(
            "%s: %s; clusters get no probability (or --bump-from scan, --bump-from FILE.csv)",
            name,
            source.roles.bump_reason,
        )
    elif not presses:
        LOGGER.warning("%s: no positive: %s never fired", name, source.start.bump_source)
    elif any(press.start_ns <= first_ns and last_ns < press.end_ns for press in presses):
        LOGGER.warning("%s: no scan without collision: the bumper is held all the time", name)
    elif presses[0].held_from_start:
        LOGGER.warning("%s: the first press is on from the start of the log", name)


def tell_of_model(model: CollisionModel) -> None:
    """Say where the parameters do not suit the data."""
    if model.meta_points.n_points == 0:
        return
    check = model.self_check()
    if not model.clustering.converged:
        LOGGER.warning(
            "affinity propagation did not converge; the best state it saw is taken "
            "(--set damping=0.95 or --set max-iter=5000 may help)"
        )
    if check.theta_too_small:
        LOGGER.warning(
            "%.0f %% of the scans are noise-points: theta %g may be too small (--set theta=...)",
            100 * check.noise_share,
            model.settings.meta_point.theta,
        )
    elif check.theta_too_large:
        LOGGER.warning(
            "only %s: theta %g may be too large, or the log short",
            count(check.n_cluster_points, "cluster-point"),
            model.settings.meta_point.theta,
        )


def tell_of_appearance(model: AppearanceModel) -> None:
    """Say where floor has no label, and what was met both as obstacle and as floor (4.2.4)."""
    n_labels = model.n_labels
    if n_labels["obstacle"] and not n_labels["free"]:
        LOGGER.warning(
            "%s: %s of obstacles, none of free floor: the robot never drives on by its odometry "
            "(--set driven-min-m=0 if that stands still)",
            model.logs[-1].name,
            count(n_labels["obstacle"], "label"),
        )
    for found in model.discrepancies():
        LOGGER.info(
            "cluster %d of patches is no clear case: p(obstacle) %.2f, from %s and %s",
            found.cluster,
            found.p_collision,
            count(found.presses, "press"),
            count(found.collisions + found.non_collisions, "label"),
        )


def tell_of_heading(logs: Sequence[ObservedLog], params: ScanParams) -> None:
    """Print a better --forward where presses were met from another side.

    Parameters
    ----------
    logs : sequence of ObservedLog
        Logs whose forward direction is an assumption.
    params : ScanParams
        How ranges are cleaned.
    """
    for log in logs:
        bearings = _bearings_at_presses(log, params)
        if not bearings.size:
            continue
        mean = np.exp(1j * bearings).mean()
        off_rad = float(np.angle(mean))
        if abs(off_rad) > OFF_COURSE_RAD and abs(mean) > SAME_SIDE:
            degrees = math.degrees(log.forward_rad + off_rad)
            rounded = HEADING_STEP_DEG * round(degrees / HEADING_STEP_DEG)
            LOGGER.warning(
                "%s: at presses the nearest returns lie %.0f degrees off; try --forward %d",
                log.name,
                math.degrees(off_rad),
                (rounded + 180) % 360 - 180,
            )


def _bearings_at_presses(log: ObservedLog, params: ScanParams) -> Float64Array:
    """Return the bearing of the nearest return in the last scan before each press."""
    starts_ns = np.array([press.start_ns for press in log.presses or ()], dtype=np.int64)
    embedder = ScanEmbedder(params, log.forward_rad, log.range_max)
    latest = np.full(len(starts_ns), np.nan)
    for block in log.blocks():
        rows = np.searchsorted(block.stamps_ns, starts_ns) - 1
        if (rows >= 0).any():
            bearings = embedder.nearest_bearing(block)
            latest[rows >= 0] = bearings[rows[rows >= 0]]
    seen: Float64Array = latest[np.isfinite(latest)]
    return seen
