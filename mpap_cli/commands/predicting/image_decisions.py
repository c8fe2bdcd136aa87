"""One log on its way through ``predict``: decisions at its images, and how they turned out."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mpap_cli.commands.inputs.press_tracking import LogPresses
from mpap_cli.commands.inputs.sources import Source
from mpap_cli.evaluation.driving import drives_ahead, nearest_straight_ahead, values_at
from mpap_cli.evaluation.leads import Lead
from mpap_cli.evaluation.rows import DecisionRow, PatchRow
from mpap_cli.evaluation.stopping import Stops, announced_contacts, stopping_distances
from mpap_cli.observations import (
    NS_PER_S,
    Batch,
    BoolArray,
    Float64Array,
    IntArray,
    PatchBlock,
    PatchPrediction,
    PoseBlock,
    Press,
)
from mpap_cli.params import Settings
from mpap_cli.systems.decision import ACTIONS, Decider


@dataclass(frozen=True, slots=True, eq=False)
class Outlook:
    """What was decided at the images of one batch.

    ``actions`` (n,) index into ``ACTIONS``; ``obstacle`` (n, n_patches) marks known patches
    that count as obstacles.
    """

    block: PatchBlock
    prediction: PatchPrediction
    actions: IntArray
    obstacle: BoolArray


class LogDecisions:
    """Collects the decisions of one log, and what its scans and odometry say of them.

    Parameters
    ----------
    source : Source
        The log.
    settings : Settings
        How ranges are cleaned, bumps read and motions decided.
    """

    def __init__(self, source: Source, settings: Settings) -> None:
        self._source = source
        self._settings = settings
        self._rows, self._columns = settings.image.rows_columns()
        self._decider = Decider(settings.obstacle, (self._rows, self._columns))
        self._presses = LogPresses(source, settings.bumper)
        self._counts: list[IntArray] = []
        self._scans: list[tuple[IntArray, Float64Array]] = []
        self._poses: list[PoseBlock] = []

    def decide(self, block: PatchBlock, prediction: PatchPrediction) -> Outlook:
        """Decide at the images of a batch (section 4.2.6)."""
        actions = self._decider.decide(prediction.p_obstacle, prediction.unknown).astype(np.int64)
        at_least = self._settings.obstacle.patch_threshold
        obstacle = ~prediction.unknown & (prediction.p_obstacle >= at_least)
        counts = (block.stamps_ns, actions, obstacle.sum(axis=1), prediction.unknown.sum(axis=1))
        self._counts.append(np.stack(counts, axis=1).astype(np.int64))
        return Outlook(block, prediction, actions, obstacle)

    def look_around(self, batch: Batch) -> None:
        """Take in the scans, bumps and poses of a batch."""
        self._presses.add(batch)
        if batch.poses is not None:
            self._poses.append(batch.poses)
        start = self._source.start
        for block in batch.scans:
            nearest_m = nearest_straight_ahead(
                block, self._settings.scan, start.forward_rad, start.range_max
            )
            self._scans.append((block.stamps_ns, nearest_m))

    def patch_rows(self, outlook: Outlook) -> Iterator[PatchRow]:
        """Yield the rows of patches.csv for one batch."""
        found = outlook.prediction
        for image, stamp_ns in enumerate(outlook.block.stamps_ns.tolist()):
            for patch in range(self._rows * self._columns):
                row, column = divmod(patch, self._columns)
                cluster = int(found.cluster[image, patch])
                yield PatchRow(
                    log=self._source.name,
                    log_index=self._source.index,
                    stamp_ns=stamp_ns,
                    row=row,
                    column=column,
                    cluster=cluster if cluster >= 0 else None,
                    p_obstacle=_cell(float(found.p_obstacle[image, patch])),
                    unknown=int(found.unknown[image, patch]),
                )

    def end(self) -> "JudgedLog":
        """Judge the decisions of the whole log."""
        table = np.concatenate([np.empty((0, 4), dtype=np.int64), *self._counts])
        stamps_ns, actions = table[:, 0], table[:, 1]
        nearest_m = np.full(stamps_ns.size, np.nan)
        if self._scans:
            at_ns, ahead_m = (np.concatenate(parts) for parts in zip(*self._scans, strict=True))
            nearest_m = values_at(stamps_ns, at_ns, ahead_m)
        path = _joined(self._poses)
        driving = None if path is None else drives_ahead(stamps_ns, path)
        presses = self._presses.end()
        return JudgedLog(
            source=self._source,
            table=table,
            nearest_m=nearest_m,
            presses=presses or (),
            stops=stopping_distances(stamps_ns, actions, nearest_m, driving),
            leads=announced_contacts(stamps_ns, actions, presses or (), driving),
            path=path,
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JudgedLog:
    """All decisions of a log; ``table`` (n, 4): stamp, action, obstacle and unknown patches."""

    source: Source
    table: IntArray
    nearest_m: Float64Array
    presses: tuple[Press, ...]
    stops: Stops
    leads: list[Lead]
    path: PoseBlock | None

    def rows(self) -> Iterator[DecisionRow]:
        """Yield the rows of decisions.csv."""
        start_ns = self.source.start.start_ns
        for (stamp_ns, action, n_obstacle, n_unknown), nearest_m in zip(
            self.table.tolist(), self.nearest_m.tolist(), strict=True
        ):
            yield DecisionRow(
                log=self.source.name,
                log_index=self.source.index,
                time_s=(stamp_ns - start_ns) / NS_PER_S,
                stamp_ns=stamp_ns,
                action=ACTIONS[action],
                obstacle_patches=n_obstacle,
                unknown_patches=n_unknown,
                nearest_ahead_m=_cell(nearest_m),
            )


def _joined(poses: list[PoseBlock]) -> PoseBlock | None:
    if not poses:
        return None
    stamps_ns = np.concatenate([block.stamps_ns for block in poses])
    return PoseBlock(stamps_ns, np.concatenate([block.poses for block in poses]))


def _cell(value: float) -> float | None:
    return None if np.isnan(value) else value
