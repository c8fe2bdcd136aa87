"""Alarms of whole evaluations: by fold, held, and judged beside the threshold."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mpap_cli.evaluation.alarms import make_alarms
from mpap_cli.evaluation.scoring import Evaluation, Variant, evaluate_all
from mpap_cli.evaluation.sheets import Question
from mpap_cli.evaluation.targets import parse_target
from mpap_cli.observations import ObservedLog
from mpap_cli.params import Settings, make_settings
from mpap_cli.properties.alarms import alarm_levels

MakeLog = Callable[..., ObservedLog]


@pytest.fixture
def logs(make_log: MakeLog) -> tuple[ObservedLog, ...]:
    """Return three logs with two, two and four presses."""
    return tuple(make_log(f"log{i}", n, i) for i, n in enumerate((2, 2, 4)))


def evaluated(logs: tuple[ObservedLog, ...], settings: Settings) -> Evaluation:
    """Score logs by models that never saw them."""
    question = Question(logs=logs, target=parse_target("early:1"), protocol="leave-one-log-out")
    return evaluate_all(question, [Variant("mpap", settings)], baselines=False)


def test_a_wall_that_comes_near_raises_an_alarm(
    logs: tuple[ObservedLog, ...], settings: Settings
) -> None:
    """Each press is announced, some time before it, in both tables."""
    timeline = evaluated(logs, settings).timeline

    assert timeline.alarms is not None
    summary = timeline.alarms.point.every
    assert (summary.announced, summary.judged) == (8, 8)
    assert summary.false_alarms_per_min == 0
    leads = [row.alarm_lead_s for row in timeline.press_rows()]
    assert all(lead is not None and 0 < lead < 5 for lead in leads)
    assert float(np.median([lead or 0.0 for lead in leads])) == summary.median_lead_s
    share = np.mean([row.alarm or 0 for row in timeline.rows()])
    assert 0.1 < share < 0.5


def test_alarms_are_those_of_each_log_by_itself(
    logs: tuple[ObservedLog, ...], settings: Settings
) -> None:
    """Nothing is held from one log into the next."""
    timeline = evaluated(logs, settings).timeline

    assert timeline.alarms is not None
    for index in range(3):
        rows = timeline.sheet.rows.log_index == index
        stamps_ns, odds = timeline.sheet.rows.stamps_ns[rows], timeline.prediction.alarm[rows]
        levels = alarm_levels(stamps_ns, odds, settings.properties)
        assert timeline.alarms.levels[rows].tolist() == levels.tolist()


def test_settings_say_where_alarms_begin(logs: tuple[ObservedLog, ...], settings: Settings) -> None:
    """At the most alarming of all that was learnt, or sooner."""
    high = replace(
        settings, properties=replace(settings.properties, alarm_lift=1e6, alarm_share=0.0)
    )

    usual, timeline = evaluated(logs, settings).timeline, evaluated(logs, high).timeline

    assert timeline.alarms is not None
    assert timeline.alarms.point.every.announced < 8
    lasting = [sum(row.alarm or 0 for row in one.rows()) for one in (usual, timeline)]
    assert lasting[0] > 5 * lasting[1]


def test_profile_paper_has_no_alarms(logs: tuple[ObservedLog, ...]) -> None:
    """It announces by its threshold alone."""
    timeline = evaluated(logs, make_settings("paper")).timeline

    assert timeline.alarms is None
    assert {row.alarm for row in timeline.rows()} == {None}
    assert {row.alarm_lead_s for row in timeline.press_rows()} == {None}


def test_without_a_model_there_is_no_alarm(
    logs: tuple[ObservedLog, ...], settings: Settings
) -> None:
    """Where no model spoke nothing is raised, and no press judged."""
    sheet = evaluated(logs, settings).timeline.sheet

    alarms = make_alarms(sheet, np.full(sheet.rows.n_scans, np.nan), settings.properties)

    assert {alarms.at(scan) for scan in range(sheet.rows.n_scans)} == {None}
    assert alarms.point.every.judged == 0
