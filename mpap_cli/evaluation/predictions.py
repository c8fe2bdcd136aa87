"""What mpap says of every scan: by a model that never saw it, in-sample, or in replay."""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from mpap_cli.evaluation.sheets import Sheet
from mpap_cli.observations import NS_PER_S, BoolArray, IntArray, ObservedLog, Prediction
from mpap_cli.params import Settings
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.labelling import LogStart
from mpap_cli.systems.training import LabelledFeatures, train


def predict_held_out(sheet: Sheet, settings: Settings, target: str) -> Prediction:
    """Predict each scan by the model of its fold.

    Parameters
    ----------
    sheet : Sheet
        n scans with labels and folds.
    settings : Settings
        With the warning time of the target.
    target : str
        ``contact``, ``onset`` or ``early``.

    Returns
    -------
    Prediction
        Of all n scans; cluster -1 and NaN where the fold had nothing to learn from.
    """
    found = _unknown(sheet.rows.n_scans)
    for fold in range(sheet.folds.plan.n_folds):
        test = sheet.test(fold)
        model = _learn_part(sheet, settings, sheet.folds.train(fold))
        if model is not None and test.any():
            _fill(found, np.flatnonzero(test), model.predict(sheet.rows.block(test), target))
    return found


def learn_all(sheet: Sheet, logs: Sequence[ObservedLog], settings: Settings) -> CollisionModel:
    """Train on all scans of a sheet, log by log, with visits and names as ``learn`` does."""
    model = CollisionModel(settings)
    for index, log in enumerate(logs):
        model.begin_log(LogStart.of(log))
        model.learn(sheet.rows.block(sheet.rows.log_index == index))
        model.end_log(log.end_ns)
    model.finish()
    return model


def predict_all(sheet: Sheet, model: CollisionModel, target: str) -> Prediction:
    """Predict all scans of a sheet by one model."""
    return model.predict(sheet.rows.block(np.arange(sheet.rows.n_scans)), target)


def predict_prequential(
    sheet: Sheet, logs: Sequence[ObservedLog], settings: Settings, target: str
) -> Prediction:
    """Predict each scan by the model in force while the logs are replayed (Fig. 9).

    Scans are predicted and then learnt, a second of log time at once; labels are counted
    when the presses around them are known, some seconds later.
    """
    rows = sheet.rows
    replay = _Replay(CollisionModel(settings, online=True), sheet, target)
    for index, log in enumerate(logs):
        replay.model.begin_log(LogStart.of(log))
        inside = np.flatnonzero(rows.log_index == index)
        seconds = (rows.stamps_ns[inside] - log.start_ns) // NS_PER_S
        for step in np.split(inside, np.flatnonzero(np.diff(seconds)) + 1):
            replay.predict_then_learn(step)
        replay.model.end_log(log.end_ns)
    replay.model.finish()
    return replay.found


class _Replay:
    """A model that grows, and what it said of each scan before it learnt it."""

    def __init__(self, model: CollisionModel, sheet: Sheet, target: str) -> None:
        self.model = model
        self.found = _unknown(sheet.rows.n_scans)
        self._rows = sheet.rows
        self._target = target

    def predict_then_learn(self, step: IntArray) -> None:
        """Take a few scans, by their rows, that follow one another."""
        if step.size:
            block = self._rows.block(step)
            _fill(self.found, step, self.model.predict(block, self._target))
            self.model.learn(block)
            self.model.settle((), int(block.stamps_ns[-1]))


def _learn_part(sheet: Sheet, settings: Settings, chosen: BoolArray) -> CollisionModel | None:
    """Train on the chosen scans, a mask (n,), log by log; None without any."""
    rows = sheet.rows
    parts = []
    for log in np.unique(rows.log_index[chosen]):
        part = chosen & (rows.log_index == log)
        parts.append(LabelledFeatures(rows.block(part), sheet.labels[part], int(log)))
    return train(settings, parts) if parts else None


def _unknown(n_scans: int) -> Prediction:
    """Say nothing of any scan."""
    return Prediction(
        cluster=np.full(n_scans, -1, dtype=np.int64),
        distance=np.full(n_scans, np.nan),
        novel=np.ones(n_scans, dtype=np.bool_),
        p_cluster=np.full(n_scans, np.nan),
        p_collision=np.full(n_scans, np.nan),
        alarm=np.full(n_scans, np.nan),
    )


def _fill(found: Prediction, rows: IntArray, part: Prediction) -> None:
    """Write the prediction of some scans into that of all."""
    for item in fields(Prediction):
        getattr(found, item.name)[rows] = getattr(part, item.name)
