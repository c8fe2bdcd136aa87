"""What must be settled before a log is replayed: straight ahead, range_max, usual beams."""

import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpap_cli.logs.raw import LogReader, Topic
from mpap_cli.logs.scan_runs import ScanPiece, read_scans
from mpap_cli.logs.tf import find_forward, is_base
from mpap_cli.logs.topics import Roles
from mpap_cli.observations import BoolArray, Float32Array, ScanGeometry

_LOG = logging.getLogger(__name__)

_SURVEYED_SCANS = 200
_ROBUST_QUANTILE = 0.99
BEAM_CODES = (
    "zero",
    "nan",
    "inf",
    "-inf",
    "negative",
    "above range_max",
    "below range_min",
    "valid",
)


@dataclass(frozen=True, slots=True)
class Survey:
    """What the first scans and the transforms of a log say.

    Parameters
    ----------
    forward_rad : float
        Straight ahead in the frame of the scanner.
    forward_source : str
        ``option``, ``tf``, ``frame`` (the scans are in the robot's own) or ``assumed``.
    range_max : float or None
        Metres, where the message's own is unusable: the 99 % quantile of the returns.
        None: the message's is good, or there is no return to go by.
    geometry : ScanGeometry or None
        Of the first scan with the usual number of beams; None without scans.
    no_return_shares : dict of str to float
        Share of beams of each of `BEAM_CODES`; empty without scans.
    """

    forward_rad: float
    forward_source: str
    range_max: float | None
    geometry: ScanGeometry | None
    no_return_shares: dict[str, float]


def survey_log(reader: LogReader, roles: Roles, forward_rad: float | None = None) -> Survey:
    """Look at the transforms and the first 200 scans.

    Parameters
    ----------
    reader : LogReader
        An open log.
    roles : Roles
        Its topics.
    forward_rad : float, optional
        Straight ahead in the frame of the scanner, counter-clockwise; else from tf.

    Returns
    -------
    Survey
        Without scans: no geometry, no shares.
    """
    scans = _first_scans(reader, roles.scan) if roles.scan is not None else []
    usual = usual_beams(scans)
    whole = [piece for piece in scans if not is_broken(piece.geometry, usual)]
    geometry = whole[0].geometry if whole else None
    source = "option"
    if forward_rad is None:
        forward_rad, source = _forward_of(reader, geometry)
    range_max = _range_max(reader, whole) if geometry is not None else None
    return Survey(forward_rad, source, range_max, geometry, _shares(whole))


def usual_beams(scans: Sequence[ScanPiece]) -> float:
    """Return the median number of beams; 0 without scans."""
    if not scans:
        return 0.0
    n_beams = [piece.geometry.n_beams for piece in scans]
    return float(np.median(np.repeat(n_beams, [len(piece.stamps_ns) for piece in scans])))


def is_broken(geometry: ScanGeometry, usual: float) -> bool:
    """Tell whether a scan has fewer than half the usual beams."""
    return geometry.n_beams < usual / 2


def survey_beams(reader: LogReader, topic: Topic) -> float:
    """Return the median number of beams of the first 200 scans; 0 without scans."""
    return usual_beams(_first_scans(reader, topic))


def _first_scans(reader: LogReader, topic: Topic) -> list[ScanPiece]:
    """Read those of the first messages that can be read."""
    scans: list[ScanPiece] = []
    n_left = _SURVEYED_SCANS
    for group in reader.runs({topic.name}):
        for run in group.runs:
            if n_left and run.topic.msgtype == topic.msgtype:
                first = run.rows(slice(n_left))
                scans.extend(read_scans(first)[0])
                n_left -= len(first)
        if not n_left:
            break
    return scans


def _forward_of(reader: LogReader, geometry: ScanGeometry | None) -> tuple[float, str]:
    """Ask the transforms; without them angle 0 is ahead."""
    if geometry is None:
        return 0.0, "assumed"
    found = find_forward(reader, geometry.frame_id)
    if found is not None:
        return found, "frame" if is_base(geometry.frame_id) else "tf"
    _LOG.info(
        "%s: no transform from the robot to its scanner (frame '%s'); angle 0 is taken as "
        "straight ahead, --forward DEG says otherwise",
        reader.path.name,
        geometry.frame_id,
    )
    return 0.0, "assumed"


def _has_range_max(geometry: ScanGeometry) -> bool:
    """Tell whether the message's range_max can be used."""
    return geometry.range_min < geometry.range_max < math.inf


def _range_max(reader: LogReader, scans: Sequence[ScanPiece]) -> float | None:
    """Find a range_max where the message's is not above range_min."""
    geometry = scans[0].geometry
    if _has_range_max(geometry):
        return None
    ranges = np.concatenate([piece.ranges.reshape(-1) for piece in scans])
    returns = ranges[np.isfinite(ranges) & (ranges > max(geometry.range_min, 0.0))]
    found = float(np.quantile(returns, _ROBUST_QUANTILE)) if returns.size else None
    taken = f"{found:.2f} m, from its first scans, is taken" if found else "there is no return"
    _LOG.warning(
        "%s: the scans give no usable range_max (%g); %s; --max-range M says otherwise",
        reader.path.name,
        geometry.range_max,
        taken,
    )
    return found


def _shares(scans: Sequence[ScanPiece]) -> dict[str, float]:
    """Count which codes the beams carry."""
    if not scans:
        return {}
    counts = np.zeros(len(BEAM_CODES))
    for piece in scans:
        codes = _coded(piece.ranges, piece.geometry)
        counts += [np.count_nonzero(of_code) for of_code in codes]
    return dict(zip(BEAM_CODES, (counts / counts.sum()).tolist(), strict=True))


def _coded(ranges: Float32Array, geometry: ScanGeometry) -> tuple[BoolArray, ...]:
    """Split beams into the classes of `BEAM_CODES`; each beam is in one."""
    far = np.float32(geometry.range_max if _has_range_max(geometry) else math.inf)
    finite = np.isfinite(ranges)
    zero = ranges == 0
    negative = finite & (ranges < 0)
    above = finite & (ranges > far)
    below = finite & (ranges > 0) & (ranges < np.float32(geometry.range_min)) & ~above
    valid = finite & ~(zero | negative | above | below)
    return (
        zero,
        np.isnan(ranges),
        np.isposinf(ranges),
        np.isneginf(ranges),
        negative,
        above,
        below,
        valid,
    )
