"""Thirteen public logs of five groups of robots with 18 presses, group by group left out."""

import os
from pathlib import Path

import pytest

from mpap_cli.evaluation.groups import group_names
from mpap_cli.evaluation.rows import AucRow
from mpap_cli.evaluation.scoring import Variant, evaluate_all
from mpap_cli.evaluation.sheets import Question
from mpap_cli.evaluation.targets import parse_target
from mpap_cli.logs.reader import open_log
from mpap_cli.logs.replay import Replay
from mpap_cli.logs.survey import survey_log
from mpap_cli.logs.topics import TopicChoice, choose_roles
from mpap_cli.observations import ObservedLog, ScanBlock
from mpap_cli.params import Settings, make_settings
from mpap_cli.properties.presses import PressTracker

pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif("MPAP_SHARED" not in os.environ, reason="MPAP_SHARED names no logs"),
]


def read_log(path: Path, settings: Settings) -> ObservedLog:
    """Read scans and presses of one log."""
    with open_log(path) as reader:
        roles = choose_roles(reader, TopicChoice())
        survey = survey_log(reader, roles)
        replay = Replay(reader, roles, settings.bumper)
        assert replay.bump_kind is not None
        tracker = PressTracker(replay.bump_kind, settings.bumper, replay.hold_s)
        blocks: list[ScanBlock] = []
        for batch in replay:
            blocks.extend(batch.scans)
            tracker.add(batch.bumps)
        tracker.end(replay.end_ns)
    return ObservedLog(
        name=path.name,
        path=str(path),
        start_ns=replay.start_ns,
        end_ns=replay.end_ns,
        forward_rad=survey.forward_rad,
        range_max=survey.range_max,
        presses=tracker.presses,
        bump_source="bumper",
        blocks=lambda: iter(blocks),
    )


@pytest.fixture(scope="module")
def logs() -> tuple[ObservedLog, ...]:
    """Return the thirteen logs."""
    folder = Path(os.environ["MPAP_SHARED"]) / "data" / "logs" / "real"
    settings = make_settings()
    return tuple(read_log(path, settings) for path in sorted(folder.glob("neato-*")))


def question_of(logs: tuple[ObservedLog, ...], target: str) -> Question:
    """Ask for each group by models that never saw it."""
    groups = group_names(logs, r"neato-\d+-([a-z])")
    return Question(logs=logs, target=parse_target(target), groups=groups)


def rows_of(logs: tuple[ObservedLog, ...], target: str) -> dict[str, AucRow]:
    """Score profile robust, profile paper and the baselines."""
    question = question_of(logs, target)
    variants = [Variant("robust", make_settings()), Variant("paper", make_settings("paper"))]
    return {one.row.method: one.row for one in evaluate_all(question, variants).marks}


@pytest.mark.slow
@pytest.mark.parametrize(("target", "presses"), [("onset", 17), ("early:1", 17)])
def test_robust_profile_foresees_on_robots_it_never_saw(
    logs: tuple[ObservedLog, ...], target: str, presses: int
) -> None:
    """It orders better than the nearest ranges, the forest and the paper's settings."""
    rows = rows_of(logs, target)

    others = ("nearest-range", "nearest-range-1s", "random-forest", "paper")
    robust = rows["robust"].auc
    assert robust is not None
    assert robust > 0.85
    assert all(robust > (rows[name].auc or 1.0) for name in others)
    assert rows["robust"].presses == presses
    assert rows["robust"].folds_scored == 5


@pytest.mark.slow
def test_probabilities_of_contact_are_worth_something(logs: tuple[ObservedLog, ...]) -> None:
    """More than the base rate is, and neither far too bold nor far too shy."""
    variants = [Variant("robust", make_settings())]

    row = evaluate_all(question_of(logs, "contact"), variants, baselines=False).marks[0].row

    assert row.brier_skill is not None
    assert row.calibration_slope is not None
    assert row.brier_skill > 0.2
    assert 0.7 < row.calibration_slope < 1.4


@pytest.mark.slow
def test_alarms_come_before_most_presses_that_can_be_seen(logs: tuple[ObservedLog, ...]) -> None:
    """Four of five, with fewer than one false alarm a minute, a fifth of the time at most."""
    variants = [Variant("robust", make_settings())]

    found = evaluate_all(question_of(logs, "onset"), variants, baselines=False)

    assert found.timeline.alarms is not None
    every, visible = found.timeline.alarms.point.every, found.timeline.alarms.point.visible
    assert visible.announced >= 0.8 * visible.judged
    assert every.median_lead_s is not None
    assert every.median_lead_s > 1
    assert every.false_alarms_per_min is not None
    assert every.false_alarms_per_min < 1
    assert every.alarm_share is not None
    assert every.alarm_share < 0.2
