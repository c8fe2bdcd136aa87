"""Protocols hold out what they say, and never learn what they score."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.errors import UsageError
from mpap_cli.evaluation.history import History, make_history
from mpap_cli.evaluation.protocols import bootstrap_units, choose_protocol, plan_folds
from mpap_cli.evaluation.targets import Target
from mpap_cli.observations import NS_PER_S, IntArray, ObservedLog, Press
from mpap_cli.params import EvaluationParams

PARAMS = EvaluationParams()


def log_of(name: str, seconds: float, start_s: float = 1000) -> ObservedLog:
    """Make a log without scans."""
    start, end = int(start_s * NS_PER_S), int((start_s + seconds) * NS_PER_S) - 1
    return ObservedLog(name, f"robot/{name}", start, end, 0.0, None, (), "bumper", lambda: iter(()))


def press(start_s: float, end_s: float, *, held: bool = False) -> Press:
    """Make a press in a log that starts at 1000 s."""
    first, last = int((1000 + start_s) * NS_PER_S), int((1000 + end_s) * NS_PER_S)
    return Press(first, last, held_from_start=held)


def history_of(*presses: tuple[Press, ...], target: str = "contact") -> History:
    """Put logs of 100 s, one for each tuple of presses, on one clock."""
    logs = [log_of(f"log{i}", 100) for i in range(len(presses))]
    return make_history(logs, presses, Target(target))


def scans(history: History) -> tuple[IntArray, IntArray]:
    """Make a scan each half second of each log: log numbers and times in the history."""
    log_index = np.repeat(np.arange(history.n_logs), 200)
    stamps = np.tile(np.arange(200) * (NS_PER_S // 2), history.n_logs) + 1000 * NS_PER_S
    return log_index, history.times(log_index, stamps)


def test_history_removes_the_gap_between_logs() -> None:
    """The second log begins where the first ends, whatever its stamps."""
    history = history_of((press(10, 11),), (press(20, 22),))

    assert (history.press_start_ns / NS_PER_S).tolist() == [10, 120]
    assert history.length_ns == 200 * NS_PER_S


def test_press_held_from_the_start_counts_for_contact_only() -> None:
    """It has no onset and cannot be foreseen."""
    held = (press(0, 5, held=True), press(50, 51))

    assert history_of(held).n_presses == 2
    assert history_of(held, target="onset").n_presses == 1


def test_blocks_end_midway_between_presses() -> None:
    """Three presses are three blocks, cut midway, with a guard of 10 % at most 5 s."""
    history = history_of((press(10, 12), press(30, 32), press(90, 92)))

    plan = plan_folds("blocked", history, None, PARAMS)

    assert plan.n_folds == 3
    assert plan.edges_ns is not None
    assert plan.guard_ns is not None
    assert (plan.edges_ns[1:-1] / NS_PER_S).tolist() == [21, 61]
    assert (plan.guard_ns / NS_PER_S).tolist() == [2.1, 4.0, 3.9]


@given(st.lists(st.integers(1, 95), unique=True, min_size=2, max_size=12), st.integers(2, 6))
def test_blocks_share_the_presses_evenly(starts: list[int], folds: int) -> None:
    """Every block holds about the same number of presses, in one piece of time."""
    history = history_of(tuple(press(start, start + 0.5) for start in sorted(starts)))

    plan = plan_folds("blocked", history, None, EvaluationParams(folds=folds))

    blocks = plan.place(history.press_log, history.press_start_ns).test
    ends = plan.place(history.press_log, history.press_end_ns).test
    counts = np.bincount(blocks, minlength=plan.n_folds)
    assert plan.n_folds == min(folds, len(starts))
    assert counts.max() - counts.min() <= 1
    assert np.array_equal(blocks, ends)


@pytest.mark.parametrize("protocol", ["blocked", "leave-one-log-out", "leave-one-group-out"])
def test_no_scan_is_learnt_by_the_model_that_scores_it(protocol: str) -> None:
    """Each scan is scored once, by a fold whose training scans do not hold it."""
    history = history_of((press(10, 11),), (press(50, 51), press(80, 81)), (press(5, 6),))
    log_index, times = scans(history)

    folds = plan_folds(protocol, history, ["a", "b", "a"], PARAMS).place(log_index, times)

    for fold in range(folds.plan.n_folds):
        assert (folds.test == fold).any()
        assert folds.train(fold).any()
        assert not (folds.train(fold) & (folds.test == fold)).any()


def test_guard_lies_on_either_side_of_a_block() -> None:
    """Scans within the guard of a block are neither learnt nor scored by its model."""
    history = history_of((press(10, 12), press(30, 32), press(90, 92)))
    log_index, times = scans(history)

    folds = plan_folds("blocked", history, None, PARAMS).place(log_index, times)

    learnt = times[folds.train(1)] / NS_PER_S
    assert learnt[learnt < 40].max() == 16.5
    assert learnt[learnt > 40].min() == 65


def test_groups_stay_together() -> None:
    """Logs of one group are learnt or scored together."""
    history = history_of((press(10, 11),), (press(50, 51),), (press(5, 6),))
    log_index, times = scans(history)

    plan = plan_folds("leave-one-group-out", history, ["x", "y", "x"], PARAMS)

    assert plan.n_folds == 2
    assert plan.place(log_index, times).test[[0, 200, 400]].tolist() == [0, 1, 0]


def test_prequential_learns_from_the_past_only() -> None:
    """A block's model knows nothing of the block or of what comes after it."""
    history = history_of((press(10, 11), press(50, 51), press(80, 81)))
    log_index, times = scans(history)

    folds = plan_folds("prequential", history, None, PARAMS).place(log_index, times)

    assert not folds.train(0).any()
    assert times[folds.train(1)].max() < times[folds.test == 1].min()


def test_in_sample_learns_all_and_a_given_model_nothing() -> None:
    """Both are one fold that scores every scan."""
    history = history_of((press(10, 11),))
    log_index, times = scans(history)

    in_sample = plan_folds("in-sample", history, None, PARAMS).place(log_index, times)
    given_model = plan_folds("given-model", history, None, PARAMS).place(log_index, times)

    assert in_sample.train(0).all()
    assert not given_model.train(0).any()
    assert not in_sample.test.any()


@pytest.mark.parametrize(
    ("presses", "protocol", "reason"),
    [
        (((),), "blocked", "no press: a held-out score needs two presses"),
        (((press(1, 2),),), "blocked", "one press only: a held-out score needs two presses"),
        (
            ((press(1, 2), press(5, 6)), ()),
            "leave-one-log-out",
            "one log only has presses: the other logs have none to learn from",
        ),
        (
            ((press(1, 2),), (press(5, 6),)),
            "leave-one-group-out",
            "one group only has presses: the other groups have none to learn from",
        ),
    ],
)
def test_too_few_presses_give_a_reason_in_words(
    presses: tuple[tuple[Press, ...], ...], protocol: str, reason: str
) -> None:
    """Without a press to learn and another to score there is no fold."""
    history = history_of(*presses)

    plan = plan_folds(protocol, history, ["g"] * len(presses), PARAMS)

    assert plan.n_folds == 0
    assert plan.reason == reason


@pytest.mark.parametrize(
    ("n_logs", "groups", "asked", "protocol"),
    [
        (1, None, None, "blocked"),
        (2, None, None, "blocked"),
        (3, None, None, "leave-one-log-out"),
        (1, ["g"], None, "leave-one-group-out"),
        (3, None, "in-sample", "in-sample"),
    ],
)
def test_protocol_follows_from_what_there_is(
    n_logs: int, groups: list[str] | None, asked: str | None, protocol: str
) -> None:
    """Groups first, then three logs with presses, else blocks; what is asked for wins."""
    history = history_of(*[(press(10, 11), press(20, 21))] * n_logs)

    chosen, reason = choose_protocol(asked, groups, history)

    assert chosen == protocol
    assert reason


def test_protocols_that_cannot_be_are_refused() -> None:
    """A protocol must exist, and leave-one-group-out needs groups."""
    history = history_of((press(10, 11),))

    with pytest.raises(UsageError, match="found half, expected one of blocked"):
        choose_protocol("half", None, history)
    with pytest.raises(UsageError, match="needs --groups"):
        choose_protocol("leave-one-group-out", None, history)


def test_groups_go_with_their_protocol_only() -> None:
    """Groups beside another protocol would say nothing, so they are refused."""
    history = history_of((press(5, 6),), (press(5, 6),))

    with pytest.raises(UsageError, match="--groups goes with leave-one-group-out"):
        choose_protocol("blocked", ("x", "y"), history)


def test_units_are_logs_then_segments_then_nothing() -> None:
    """Five logs with presses are resampled as logs, five presses as segments."""
    logs = history_of(*[(press(10, 11),)] * 5)
    segments = history_of(tuple(press(start, start + 1) for start in range(10, 60, 10)))
    few = history_of((press(10, 11),))

    by_log, log_kind = bootstrap_units(logs, *scans(logs))
    by_time, time_kind = bootstrap_units(segments, *scans(segments))
    nothing, kind = bootstrap_units(few, *scans(few))

    assert (log_kind, time_kind, kind) == ("logs", "segments", "none")
    assert by_log is not None
    assert by_time is not None
    assert np.unique(by_log).size == 5
    assert np.unique(by_time).size == 5
    assert nothing is None
