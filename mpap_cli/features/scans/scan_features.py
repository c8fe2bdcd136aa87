"""Laser scans become embedded histograms (section 4.1, equation 7).

One value per bin makes a histogram; its embedding is the point that is clustered. The
paper's five features stand beside two of ours: ``seq-diff-signed``, the sequential
difference as printed, and ``inverse-min``, which looks all round and looks back.
"""

import logging
from dataclasses import replace

import numpy as np

from mpap_cli.features.scans import _kernels
from mpap_cli.features.scans.histograms import embed_values, inverse
from mpap_cli.features.scans.scan_bins import BinLayout, beam_bearings, lay_out_bins
from mpap_cli.features.scans.scan_cleaning import RangeLimits, clean_ranges, range_limits
from mpap_cli.features.scans.temporal import ChangeOverTime, SlidingMinimum
from mpap_cli.observations import FeatureBlock, Float32Array, Float64Array, ScanBlock
from mpap_cli.params import ScanParams

# What a feature takes from the ranges of a bin. seq-diff takes absolute steps: as printed
# the sum is (first - last) / (n - 1), which may be negative, and then equation 7 has no
# meaning. seq-diff-signed is that, as two bins max(0, v) and max(0, -v).
SCAN_FEATURES: dict[str, int] = {
    "min-value": _kernels.MIN,
    "max-value": _kernels.MAX,
    "mean-value": _kernels.MEAN,
    "global-diff": _kernels.SPAN,
    "seq-diff": _kernels.STEP,
    "seq-diff-signed": _kernels.SLOPE,
    "inverse-min": _kernels.MIN,
}

APPROACH_CAP_M = 2.0
FEW_BEAMS = "bin with fewer than 2 beams"

_log = logging.getLogger(__name__)


class ScanEmbedder:
    """Turn blocks of raw scans into blocks of embedded histograms.

    Scans come in time order, and may be cut into blocks in any way; what looks back is
    kept across blocks, also where the geometry changes.

    Parameters
    ----------
    params : ScanParams
        Feature, bins, field of view, cleaning, look-back.
    forward_rad : float, optional
        Direction of travel in the frame of the scanner.
    range_max : float, optional
        Metres, for geometries whose own range_max cannot be used.

    Attributes
    ----------
    n_dims : int
        Number of dimensions of a feature; depends on ``params`` alone.

    Notes
    -----
    ``lookback_s`` takes the minimum of every bin's value over that time, whatever the
    feature. Under ``no_return="drop"`` a bin whose beams are all dropped keeps the value
    of the scan before; in the first scan it reads range_max all over (so its differences
    are 0). A single beam that is left makes no step.

    ``keep_scale`` appends bins * cap - sum to the histogram (inverse-min:
    bins / near_floor_m - sum), so that like shapes of unlike size differ.

    inverse-min has four blocks, each embedded by itself: the nearest range all round; the
    nearest range where one straight behind counts ``rear_stretch`` times; the nearest of
    every bin, all three as 1 / max(min(r, near_cap_m), near_floor_m); and the approach,
    the change over ``approach_s`` of the nearest range ahead (at most 2 m, without the
    look-back), clipped to 0.5 m, as histogram (receding, approaching, still).
    u = concat(sqrt(w / sum w) u_block) has length 1; a block of weight 0 is left out.
    """

    def __init__(
        self, params: ScanParams, forward_rad: float = 0.0, range_max: float | None = None
    ) -> None:
        self.params = params
        nothing = np.zeros(1)
        self.n_dims = embed_values(np.ones((1, params.bins)), nothing, nothing, params, 1.0).shape[
            1
        ]
        self.for_log(forward_rad, range_max)

    def for_log(self, forward_rad: float, range_max: float | None = None) -> None:
        """Begin another log: forget what looks back, and look the way its robot drives."""
        self._forward_rad = forward_rad
        self._range_max = range_max
        self.reset()

    def reset(self) -> None:
        """Forget what looks back, as at the boundary of two logs."""
        self._embedded = _BinStream(self.params)
        self._raw = _BinStream(self.params)
        self._approach = ChangeOverTime(self.params.approach_s)
        self._n_outside = 0

    def transform(self, block: ScanBlock) -> FeatureBlock:
        """Embed the scans of a block.

        Parameters
        ----------
        block : ScanBlock
            The next scans of the log; not changed.

        Returns
        -------
        FeatureBlock
            One row per scan kept: all scans of the block, or none if its geometry puts
            fewer than two beams into a bin.

        Raises
        ------
        UsageError
            If neither the scans nor ``range_max`` nor the settings tell a usable maximum
            range.
        """
        layout = lay_out_bins(block.geometry, self._forward_rad, self.params)
        n_scans = block.stamps_ns.size
        if not layout.usable:
            none = np.empty(0, np.int64)
            features = np.empty((0, self.n_dims), np.float32)
            return FeatureBlock(none, features, none.copy(), np.empty(0, np.float32))
        self._tell_outside(layout)
        limits = self._limits(block)
        values, front, nearest = self._embedded.push(block, layout, limits)
        change = np.zeros(n_scans)
        if self.params.feature == "inverse-min":
            change = self._approach.push(block.stamps_ns, np.minimum(nearest, APPROACH_CAP_M))
        points = embed_values(values, front, change, self.params, limits.cap)
        kept = np.arange(n_scans, dtype=np.int64)
        return FeatureBlock(block.stamps_ns.copy(), points, kept, nearest)

    def raw_bins(self, block: ScanBlock) -> Float32Array:
        """Return the plain values (n, bins) of the scans kept, as they would be embedded.

        Metres, with the look-back; for inverse-min 1 / metres, for seq-diff-signed with
        their sign; without slack and further blocks. Has a look-back of its own, so that
        calls do not disturb :meth:`transform`.
        """
        layout = lay_out_bins(block.geometry, self._forward_rad, self.params)
        if not layout.usable:
            return np.empty((0, self.params.bins), np.float32)
        values, _, _ = self._raw.push(block, layout, self._limits(block))
        if self.params.feature == "inverse-min":
            values = inverse(values, self.params)
        return values.astype(np.float32)

    def nearest_bearing(self, block: ScanBlock) -> Float32Array:
        """Return where the nearest return of every scan (n,) lies, all round.

        Radians against forward, in [-pi, pi), NaN in a scan without return; of beams
        equally near, the first. Keeps no state.
        """
        limits = range_limits(
            block.geometry, replace(self.params, no_return="max"), self._range_max
        )
        if not block.geometry.n_beams:
            return np.full(block.stamps_ns.size, np.nan, np.float32)
        cleaned = clean_ranges(block.ranges, limits)
        bearings = beam_bearings(block.geometry, self._forward_rad)[np.argmin(cleaned, axis=1)]
        seen = np.min(cleaned, axis=1) < np.float32(limits.cap)
        return np.where(seen, bearings, np.float32(np.nan))

    def _limits(self, block: ScanBlock) -> RangeLimits:
        """Return what the ranges of a block are held against."""
        return range_limits(block.geometry, self.params, self._range_max)

    def _tell_outside(self, layout: BinLayout) -> None:
        """Say once a log that bins lie where the scanner does not look."""
        if layout.n_outside > self._n_outside:
            text = "%d of %d bins lie outside the field of the scanner and read 'no return'"
            _log.debug(text, layout.n_outside, self.params.bins)
            self._n_outside = layout.n_outside


class _BinStream:
    """Values of the bins of one stream of scans, with what looks back."""

    def __init__(self, params: ScanParams) -> None:
        self._statistics = np.array([SCAN_FEATURES[params.feature]], np.int64)
        self._held = np.full((1, params.bins), np.nan)
        self._wants_front = params.feature == "inverse-min"
        looks_back = params.lookback_s > 0
        self._minimum = SlidingMinimum(params.lookback_s, params.bins + 1) if looks_back else None

    def push(
        self, block: ScanBlock, layout: BinLayout, limits: RangeLimits
    ) -> tuple[Float64Array, Float64Array, Float32Array]:
        """Return values (n, bins), nearest in front (n,) and, in the scan itself, ahead (n,)."""
        ranges = block.ranges[:, ::-1] if layout.clockwise else block.ranges
        values, nearest, front = _kernels.bin_block(
            np.ascontiguousarray(ranges, np.float32),
            limits.as_array(),
            layout.runs,
            layout.stretch,
            self._statistics,
            self._held,
            wants_front=self._wants_front,
        )
        if self._minimum is None:
            return values[0], front.astype(np.float64), nearest
        columns = self._minimum.push(block.stamps_ns, np.column_stack([values[0], front]))
        return columns[:, :-1], columns[:, -1], nearest
