"""Features of all scans of all logs, for several settings in one pass over the logs.

Only features, the nearest range and the bins of the baselines are kept, not the scans.
"""

import logging
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mpap_cli.features.scans.scan_features import FEW_BEAMS, ScanEmbedder
from mpap_cli.observations import (
    BoolArray,
    FeatureBlock,
    Float32Array,
    IntArray,
    ObservedLog,
    ScanBlock,
)
from mpap_cli.params import ScanParams

RAW_FEATURE = "min-value"
RAW_BINS = 12
RAW_LOOKBACK_S = 1.0

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Look:
    """A way to look at scans: embedded histograms, or the ``plain`` values of the bins."""

    params: ScanParams
    plain: bool = False


def raw_look(params: ScanParams) -> Look:
    """Return what logistic regression and random forest look at, whatever the model does.

    The nearest range of 12 sectors all round over the last second, in metres; scans are
    cleaned as for the model.
    """
    raw = replace(params, feature=RAW_FEATURE, bins=RAW_BINS, fov="360", lookback_s=RAW_LOOKBACK_S)
    return Look(raw, plain=True)


@dataclass(frozen=True, slots=True, eq=False)
class ScanRows:
    """The kept scans of several logs, in order.

    ``log_index`` and ``stamps_ns`` are int64 (n,); ``features`` float32 (n, d);
    ``nearest_ahead_m`` float32 (n,).
    """

    log_index: IntArray
    stamps_ns: IntArray
    features: Float32Array
    nearest_ahead_m: Float32Array

    @property
    def n_scans(self) -> int:
        """Number of scans."""
        return self.log_index.size

    def block(self, chosen: BoolArray | IntArray) -> FeatureBlock:
        """Return chosen scans, a mask (n,) or their rows, as one block of features."""
        return FeatureBlock(
            stamps_ns=self.stamps_ns[chosen],
            features=self.features[chosen],
            kept=np.arange(self.n_scans)[chosen],
            nearest_ahead_m=self.nearest_ahead_m[chosen],
        )


class _Collector:
    """Blocks of one setting, joined at the end."""

    def __init__(self, look: Look) -> None:
        self._look = look
        self._embedder = ScanEmbedder(look.params)
        n_dims = look.params.bins if look.plain else self._embedder.n_dims
        nothing = np.zeros(0, dtype=np.int64)
        features = np.zeros((0, n_dims), dtype=np.float32)
        self._blocks = [FeatureBlock(nothing, features, nothing, nothing.astype(np.float32))]
        self._log_index = [nothing]

    def begin_log(self, log: ObservedLog) -> None:
        """Look at the next log; nothing looks back beyond its start."""
        self._embedder.for_log(log.forward_rad, log.range_max)

    def add(self, index: int, block: ScanBlock) -> int:
        """Take in the scans of a block; return how many could not be used."""
        found = self._embedder.transform(block)
        if self._look.plain:
            found = replace(found, features=self._embedder.raw_bins(block))
        self._blocks.append(found)
        self._log_index.append(np.full(found.stamps_ns.size, index, dtype=np.int64))
        return int(block.stamps_ns.size - found.stamps_ns.size)

    def joined(self) -> ScanRows:
        """Return all scans."""
        return ScanRows(
            log_index=np.concatenate(self._log_index),
            stamps_ns=np.concatenate([block.stamps_ns for block in self._blocks]),
            features=np.concatenate([block.features for block in self._blocks]),
            nearest_ahead_m=np.concatenate([block.nearest_ahead_m for block in self._blocks]),
        )


def observe(logs: Sequence[ObservedLog], looks: Iterable[Look]) -> dict[Look, ScanRows]:
    """Read each log once and look at its scans in every way asked for.

    Parameters
    ----------
    logs : sequence of ObservedLog
        In order.
    looks : iterable of Look
        Settings of the features.

    Returns
    -------
    dict of Look to ScanRows
        One entry for each; scans that a setting cannot use are left out of its, which a
        warning counts.
    """
    collectors = {look: _Collector(look) for look in looks}
    left_out = Counter[str]()
    for index, log in enumerate(logs):
        for collector in collectors.values():
            collector.begin_log(log)
        for block in log.blocks():
            skipped = [collector.add(index, block) for collector in collectors.values()]
            left_out[log.name] += max(skipped, default=0)
    if left_out.total():
        names = ", ".join(name for name, number in left_out.items() if number)
        _log.warning("%s: %d scans skipped: %s", names, left_out.total(), FEW_BEAMS)
    return {look: collector.joined() for look, collector in collectors.items()}
