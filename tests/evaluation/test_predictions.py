"""What is held out is never learnt, and what comes later is never known."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from mpap_cli.evaluation.observing import Look, observe
from mpap_cli.evaluation.predictions import (
    learn_all,
    predict_all,
    predict_held_out,
    predict_prequential,
)
from mpap_cli.evaluation.sheets import Question, Sheet, make_sheet
from mpap_cli.observations import NS_PER_S, ObservedLog, Press
from mpap_cli.params import Settings
from mpap_cli.systems.collision import CollisionModel

MakeLog = Callable[..., ObservedLog]
LearnLogs = Callable[[Settings, Sequence[ObservedLog]], CollisionModel]


def sheet_of(
    logs: list[ObservedLog],
    settings: Settings,
    protocol: str,
    truth: list[tuple[Press, ...] | None] | None = None,
) -> Sheet:
    """Observe logs and lay out the folds."""
    look = Look(settings.scan)
    known = None if truth is None else tuple(truth)
    question = Question(logs=tuple(logs), protocol=protocol, truth=known)
    return make_sheet(question, settings, observe(logs, [look])[look])


def test_held_out_block_does_not_know_its_own_presses(
    make_log: MakeLog, settings: Settings
) -> None:
    """Other presses inside a block change nothing in what is predicted for that block."""
    log = make_log(n_cycles=4)
    assert log.presses is not None
    changed = list(log.presses)
    changed[1] = Press(changed[1].start_ns, changed[1].end_ns - NS_PER_S)
    sheet = sheet_of([log], settings, "blocked")
    other = sheet_of([replace(log, presses=tuple(changed))], settings, "blocked", [log.presses])
    block = sheet.test(1)

    first = predict_held_out(sheet, settings, "onset").p_collision
    second = predict_held_out(other, settings, "onset").p_collision

    assert np.array_equal(block, other.test(1))
    assert np.array_equal(first[block], second[block])
    assert not np.array_equal(first[~block], second[~block])


def test_prequential_does_not_know_the_future(make_log: MakeLog, settings: Settings) -> None:
    """A log cut short is predicted as the whole log is up to the cut."""
    whole = make_log(n_cycles=4)
    assert whole.presses is not None
    cut = replace(
        whole,
        end_ns=whole.start_ns + 30 * NS_PER_S,
        presses=whole.presses[:2],
        blocks=lambda: iter(list(whole.blocks())[:2]),
    )

    known = predict_prequential(
        sheet_of([whole], settings, "prequential"), [whole], settings, "onset"
    )
    early = predict_prequential(sheet_of([cut], settings, "prequential"), [cut], settings, "onset")

    n_scans = early.p_collision.size
    assert 100 < n_scans < known.p_collision.size
    assert np.array_equal(early.p_collision, known.p_collision[:n_scans], equal_nan=True)
    assert np.isnan(known.p_collision[0])
    assert not np.isnan(known.p_collision[-1])


def test_learning_from_features_equals_learning_from_logs(
    make_log: MakeLog, settings: Settings, learn_logs: LearnLogs
) -> None:
    """The model of all scans is the one that the logs give, clusters and visits included."""
    logs = [make_log("a", 2, 0), make_log("b", 2, 1)]
    sheet = sheet_of(logs, settings, "in-sample")

    model = learn_all(sheet, logs, settings)

    assert model.clusters() == learn_logs(settings, logs).clusters()
    assert predict_all(sheet, model, "contact").p_collision.size == sheet.rows.n_scans


def test_fold_without_training_scans_says_nothing(make_log: MakeLog, settings: Settings) -> None:
    """The first block of prequential folds has no past: cluster -1 and no probability."""
    sheet = sheet_of([make_log()], settings, "prequential")

    found = predict_held_out(sheet, settings, "contact")

    first = sheet.test(0)
    assert np.all(found.cluster[first] == -1)
    assert np.isnan(found.p_collision[first]).all()
    assert not np.isnan(found.p_collision[~first]).any()


def test_log_without_scans_does_not_disturb_a_replay(make_log: MakeLog, settings: Settings) -> None:
    """A silent log between two others changes nothing in what is said of them."""
    logs = [make_log("a", 2, 0), make_log("b", 2, 2)]
    silent = replace(make_log("silent", 2, 1), presses=(), blocks=lambda: iter(()))
    more = [logs[0], silent, logs[1]]

    without = predict_prequential(
        sheet_of(logs, settings, "prequential"), logs, settings, "contact"
    )
    beside = predict_prequential(sheet_of(more, settings, "prequential"), more, settings, "contact")

    assert np.array_equal(without.p_collision, beside.p_collision, equal_nan=True)
