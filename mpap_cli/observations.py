"""Records that travel through the pipeline, from the log to the table.

What flows is a block: arrays over n observations. Stamps are integer nanoseconds.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.floating[Any]]
Float32Array = NDArray[np.float32]
Float64Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Int8Array = NDArray[np.int8]
BoolArray = NDArray[np.bool_]

NS_PER_S = 1_000_000_000
VIDEO_ENCODINGS = frozenset({"h264", "h265", "vp9", "av1"})


@dataclass(frozen=True, slots=True)
class ScanGeometry:
    """Where the beams of a laser scan point, as sensor_msgs/LaserScan says it.

    Angles are radians in the frame of the scanner, ranges metres.
    """

    n_beams: int
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    frame_id: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class ScanBlock:
    """Scans of one geometry that follow one another in one log.

    ``stamps_ns`` has shape (n,), int64, not decreasing; ``ranges`` has shape
    (n, n_beams), float32, in metres as recorded (not cleaned).
    """

    stamps_ns: IntArray
    ranges: Float32Array
    geometry: ScanGeometry


@dataclass(frozen=True, slots=True)
class Frame:
    """One camera image as recorded, not decoded.

    ``encoding`` is ``compressed`` (JPEG, PNG or WebP, told by the bytes), an encoding of
    sensor_msgs/Image, or one of ``VIDEO_ENCODINGS``: then ``payload`` is one packet, and
    ``place`` tells which packets are decoded before it. ``width``, ``height`` and ``step``
    (bytes a row) are 0 if compressed.
    """

    stamp_ns: int
    encoding: str
    width: int
    height: int
    step: int
    payload: bytes
    place: "PacketPlace | None" = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True, eq=False)
class PacketPlace:
    """Where a packet stands in its video.

    ``number`` counts packets as they were recorded, broken ones too; ``before`` is the
    packet that this one is decoded after, None where decoding begins or the one before is
    not kept; ``opened`` tells whether decoding can begin with the first packet so reached.
    """

    number: int
    before: Frame | None
    opened: bool


@dataclass(frozen=True, slots=True)
class Bump:
    """State of one bumper sensor from this moment on."""

    stamp_ns: int
    sensor: str
    pressed: bool


@dataclass(frozen=True, slots=True)
class Press:
    """One contact, as the bumper tells it: start <= t < end.

    ``held_from_start`` marks a press that is on in the first message of its topic;
    ``released`` is False when the log ends before the bumper is free (``end_ns`` is
    then one nanosecond after the last message of the log).
    """

    start_ns: int
    end_ns: int
    held_from_start: bool = False
    released: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class PoseBlock:
    """Where the robot was by its own odometry, in time order.

    ``stamps_ns`` (n,) int64; ``poses`` (n, 3) float64: x, y in metres and heading in
    radians, in the frame of the odometry.
    """

    stamps_ns: IntArray
    poses: Float64Array


@dataclass(frozen=True, slots=True)
class Batch:
    """Everything a log holds up to ``until_ns`` that was not in the batch before.

    Scans, bumps, images and poses are each in time order; no later batch of the log holds
    anything stamped at or before ``until_ns``. ``poses`` is None where none was asked for
    or the log has none.
    """

    until_ns: int
    scans: tuple[ScanBlock, ...]
    bumps: tuple[Bump, ...]
    frames: tuple[Frame, ...] = ()
    poses: PoseBlock | None = None


@dataclass(frozen=True, slots=True, eq=False)
class FeatureBlock:
    """Embedded histograms of consecutive observations of one log.

    ``features`` is float32 of shape (n, d), each row of Euclidean length 1;
    ``kept`` (n,) tells which rows of the block of scans they come from;
    ``nearest_ahead_m`` (n,) float32 is the smallest cleaned range within 90 degrees
    of straight ahead.
    """

    stamps_ns: IntArray
    features: Float32Array
    kept: IntArray
    nearest_ahead_m: Float32Array


@dataclass(frozen=True, slots=True, eq=False)
class PatchBlock:
    """Embedded patches of consecutive images of one log (section 4.2.2).

    ``stamps_ns`` (n,) are those of the images; ``features`` is float32 of shape
    (n, n_patches, d), each patch of Euclidean length 1, row by row of the grid from the
    top left; ``kept`` (n,) tells which of the frames they come from.
    """

    stamps_ns: IntArray
    features: Float32Array
    kept: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Clustering:
    """Result of affinity propagation over n items (section 3.2 of the paper).

    ``exemplars`` (k,) are item indices, ascending; ``labels`` (n,) index into
    ``exemplars``. ``preference`` is what stood on the diagonal (its mean if it was a
    vector). An unfinished run has ``converged`` False and the best state it saw.
    """

    exemplars: IntArray
    labels: IntArray
    n_iter: int
    converged: bool
    damping: float
    net_similarity: float
    preference: float


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """What a model says of n observations.

    ``cluster`` (n,) int64, ``distance`` (n,) float64 to the nearest meta-point,
    ``novel`` (n,) bool: farther than theta from every cluster-point; ``p_cluster`` and
    ``p_collision`` (n,) float64 in [0, 1], NaN where the model has no labels; ``alarm`` (n,)
    float64: odds as they were read against those from which an alarm begins, NaN where the
    model raises none.
    """

    cluster: IntArray
    distance: Float64Array
    novel: BoolArray
    p_cluster: Float64Array
    p_collision: Float64Array
    alarm: Float64Array


@dataclass(frozen=True, slots=True, eq=False)
class PatchPrediction:
    """What a model says of the patches of n images; arrays of shape (n, n_patches).

    ``cluster`` int64 (-1: the nearest exemplar is in no cluster yet), ``distance`` float64
    to the nearest exemplar, ``unknown`` bool: farther than the fit radius from every
    exemplar; ``p_obstacle`` float64 in [0, 1], filled for unknown patches too, NaN only
    where the model has no labels.
    """

    cluster: IntArray
    distance: Float64Array
    unknown: BoolArray
    p_obstacle: Float64Array


@dataclass(frozen=True, slots=True, eq=False)
class ObservedLog:
    """What one log gave: the scans (read again at each call of ``blocks``) and the presses.

    ``forward_rad`` is the direction of travel in the frame of the scanner;
    ``range_max`` replaces the message's where that is unusable (None: take the message's);
    ``presses`` is None where the log has no bumper; ``bump_source`` says in words where
    the presses come from.
    """

    name: str
    path: str
    start_ns: int
    end_ns: int
    forward_rad: float
    range_max: float | None
    presses: tuple[Press, ...] | None
    bump_source: str
    blocks: Callable[[], Iterator[ScanBlock]]
