"""Scans with everything that scoring needs: labels to learn, truth, folds, units."""

from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.history import Presses, make_history
from mpap_cli.evaluation.observing import ScanRows
from mpap_cli.evaluation.operating import JoinedLogs, join_logs
from mpap_cli.evaluation.protocols import Folds, bootstrap_units, choose_protocol, plan_folds
from mpap_cli.evaluation.targets import Target
from mpap_cli.evaluation.visible import Visible
from mpap_cli.observations import BoolArray, Int8Array, IntArray, ObservedLog
from mpap_cli.params import Settings
from mpap_cli.properties.labels import NO_LABEL, label_scans
from mpap_cli.systems.collision import CollisionModel

CONTACT_TARGET = Target("contact")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Question:
    """What is asked.

    ``groups`` names the group of each log. ``truth`` holds the presses that are scored,
    log by log (None: those of the bumper, which are always the ones learnt from), and
    ``truth_name`` says what they are: ``bumper``, ``scan``, several joined by +, or the
    base name of a file.
    ``visible`` tells which of them something near was seen before (None: not looked at,
    as if of all).
    ``model`` is scored as it is (protocol ``given-model``); ``model_logs`` are the logs
    it learnt from, on which the baselines are fitted.
    """

    logs: tuple[ObservedLog, ...]
    target: Target = CONTACT_TARGET
    protocol: str | None = None
    groups: tuple[str, ...] | None = None
    threshold: float = 0.2
    truth: tuple[Presses | None, ...] | None = None
    truth_name: str = "bumper"
    visible: tuple[Visible, ...] | None = None
    model: CollisionModel | None = None
    model_logs: tuple[ObservedLog, ...] | None = None

    def scored_presses(self) -> tuple[Presses | None, ...]:
        """Return the presses that are scored, None for a log without any knowledge."""
        if self.truth is not None:
            return self.truth
        return tuple(log.presses for log in self.logs)

    def seen_presses(self) -> tuple[Visible, ...]:
        """Return for each press that is scored whether it was visible."""
        if self.visible is not None:
            return self.visible
        return tuple((True,) * len(known or ()) for known in self.scored_presses())


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sheet:
    """The n scans of one setting, ready to be learnt and scored.

    ``labels`` (n, 3) are learnt, ``truth`` (n,) is scored (1, 0, or -1: not);
    ``truth_visible`` (n,) is the same without the positives of presses that were not
    visible, which are neither positive nor negative in it. ``unit`` (n,) is what an
    interval resamples, one of ``n_units`` (None: nothing), ``unit_kind`` its name.
    ``n_presses`` are those that the target can score, ``n_visible`` of them were visible;
    ``announcing`` is what announcements are judged on.
    """

    rows: ScanRows
    labels: Int8Array
    truth: Int8Array
    truth_visible: Int8Array
    folds: Folds
    unit: IntArray | None
    n_units: int
    unit_kind: str
    protocol: str
    protocol_reason: str
    n_presses: int
    n_visible: int
    announcing: JoinedLogs

    def learnable(self, fold: int, pair: int) -> bool:
        """Tell whether the training scans of a fold have both labels of a pair."""
        return has_both_labels(self.labels[self.folds.train(fold), pair])

    def test(self, fold: int) -> BoolArray:
        """Return which scans a fold's model scores."""
        return np.asarray(self.folds.test == fold, dtype=np.bool_)


def has_both_labels(labels: Int8Array) -> bool:
    """Tell whether labels hold positives and negatives."""
    return bool((labels == 0).any() and (labels == 1).any())


def label_rows(
    rows: ScanRows, presses: tuple[Presses | None, ...], settings: Settings
) -> Int8Array:
    """Label scans log by log: (n, 3), no label where nothing is known of presses."""
    labels = np.full((rows.n_scans, 3), NO_LABEL, dtype=np.int8)
    for index, known in enumerate(presses):
        if known is not None:
            inside = rows.log_index == index
            stamps_ns = rows.stamps_ns[inside]
            labels[inside] = label_scans(stamps_ns, known, settings.properties)
    return labels


def make_sheet(question: Question, settings: Settings, rows: ScanRows) -> Sheet:
    """Label the scans of one setting and lay out its folds.

    Parameters
    ----------
    question : Question
        Logs, target, protocol.
    settings : Settings
        With the warning time of the target (:meth:`Target.applied_to`).
    rows : ScanRows
        Scans of ``question.logs`` under these settings.

    Raises
    ------
    UsageError
        If the protocol does not exist or lacks its groups.
    """
    presses = question.scored_presses()
    history = make_history(question.logs, [known or () for known in presses], question.target)
    asked = "given-model" if question.model is not None else question.protocol
    protocol, reason = choose_protocol(asked, question.groups, history)
    plan = plan_folds(protocol, history, question.groups, settings.evaluation)
    times = history.times(rows.log_index, rows.stamps_ns)
    unit, unit_kind = bootstrap_units(history, rows.log_index, times)
    truth = label_rows(rows, presses, settings)[:, question.target.pair]
    return Sheet(
        rows=rows,
        labels=label_rows(rows, tuple(log.presses for log in question.logs), settings),
        truth=truth,
        truth_visible=_without_invisible(question, settings, rows, truth),
        folds=plan.place(rows.log_index, times),
        unit=unit,
        n_units=history.n_logs if unit_kind == "logs" else history.n_presses,
        unit_kind=unit_kind,
        protocol=protocol,
        protocol_reason=reason,
        n_presses=history.n_presses,
        n_visible=_n_visible(question),
        announcing=join_logs(rows.log_index, rows.stamps_ns, presses, question.seen_presses()),
    )


def _n_visible(question: Question) -> int:
    """Count the visible presses among those that the target can score."""
    return sum(
        bool(seen) and (question.target.name == "contact" or not press.held_from_start)
        for known, of_log in zip(question.scored_presses(), question.seen_presses(), strict=True)
        for press, seen in zip(known or (), of_log, strict=True)
    )


def _without_invisible(
    question: Question, settings: Settings, rows: ScanRows, truth: Int8Array
) -> Int8Array:
    """Take the positives of presses that were not visible out of the truth."""
    seen = question.seen_presses()
    if all(one for of_log in seen for one in of_log):
        return truth
    visible = tuple(
        None
        if known is None
        else tuple(press for press, one in zip(known, of_log, strict=True) if one)
        for known, of_log in zip(question.scored_presses(), seen, strict=True)
    )
    labels = label_rows(rows, visible, settings)[:, question.target.pair]
    return np.where((truth == 1) & (labels != 1), np.int8(NO_LABEL), truth)
