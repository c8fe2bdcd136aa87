"""Labels are learnt from the bumper; what is scored may be another truth."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from mpap_cli.evaluation.observing import Look, observe
from mpap_cli.evaluation.sheets import Question, Sheet, make_sheet
from mpap_cli.evaluation.targets import Target
from mpap_cli.observations import NS_PER_S, ObservedLog, Press
from mpap_cli.params import Settings

MakeLog = Callable[..., ObservedLog]


def sheet_of(question: Question, settings: Settings) -> Sheet:
    """Observe the logs of a question."""
    look = Look(settings.scan)
    return make_sheet(question, settings, observe(question.logs, [look])[look])


def test_log_without_bumper_has_no_label(make_log: MakeLog, settings: Settings) -> None:
    """It is neither counted nor scored, not even as clear."""
    logs = (make_log("a"), make_log("b", 2, 1, bumper=False))

    sheet = sheet_of(Question(logs=logs), settings)

    without = sheet.rows.log_index == 1
    assert np.all(sheet.labels[without] == -1)
    assert np.all(sheet.truth[without] == -1)
    assert np.all(sheet.labels[~without, 0] >= 0)


def test_truth_of_a_file_is_scored_but_not_learnt(make_log: MakeLog, settings: Settings) -> None:
    """Edited presses change the truth and the number of presses, labels stay the bumper's."""
    log = make_log()
    edited = (Press(log.start_ns, log.start_ns + NS_PER_S),)

    sheet = sheet_of(Question(logs=(log,), truth=(edited,), truth_name="mine.csv"), settings)

    assert sheet.truth.sum() == 5
    assert sheet.labels[:, 0].sum() == 4 * 7
    assert sheet.n_presses == 1


def test_truth_follows_the_target(make_log: MakeLog, settings: Settings) -> None:
    """Contact, onset and early score other scans; early:S takes its own seconds."""
    log = make_log(n_cycles=2)
    early = Target("early", 2.0)

    contact = sheet_of(Question(logs=(log,)), settings).truth
    onset = sheet_of(Question(logs=(log,), target=Target("onset")), settings).truth
    warned = sheet_of(Question(logs=(log,), target=early), early.applied_to(settings)).truth

    assert np.sum(contact == 1) == 2 * 7
    assert np.sum(onset == 1) == 2 * 5
    assert np.sum(warned == 1) == 2 * 10


def test_fold_that_lacks_a_class_cannot_be_learnt(make_log: MakeLog, settings: Settings) -> None:
    """Without the log that holds the presses there is nothing to learn from."""
    quiet = replace(make_log("quiet", 2, 1), presses=())
    question = Question(
        logs=(make_log("a"), quiet, make_log("c", 2, 2)), protocol="leave-one-log-out"
    )
    alone = replace(question, logs=(make_log("a"), quiet), protocol="blocked")

    folds = sheet_of(question, settings)
    blocks = sheet_of(alone, settings)

    assert [folds.learnable(fold, 1) for fold in range(3)] == [True, True, True]
    assert blocks.learnable(0, 1)
    assert folds.protocol == "leave-one-log-out"
