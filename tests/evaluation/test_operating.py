"""Operating points: thresholds on logs made by hand, one scan every half second."""

import numpy as np
import pytest

from mpap_cli.evaluation.leads import PressJudge
from mpap_cli.evaluation.operating import (
    JoinedLogs,
    OperatingPoint,
    join_logs,
    most_recall,
    operating_points,
    operating_rows,
)
from mpap_cli.evaluation.rows import AucRow
from mpap_cli.observations import NS_PER_S, Float64Array, Press

STEP_NS = NS_PER_S // 2


def press(start_s: float, end_s: float, *, held: bool = False) -> Press:
    """Make a press from seconds."""
    return Press(int(start_s * NS_PER_S), int(end_s * NS_PER_S), held_from_start=held)


def joined(n_scans: int, presses: list[Press], visible: list[bool | None]) -> JoinedLogs:
    """Make one log."""
    stamps_ns = np.arange(n_scans) * STEP_NS
    return join_logs(
        np.zeros(n_scans, dtype=np.int64), stamps_ns, [tuple(presses)], [tuple(visible)]
    )


def two_minutes() -> tuple[JoinedLogs, Float64Array]:
    """Make presses at 30, 60 and 90 s, the last unseen; p rises before them, and at 45 s."""
    p = np.full(240, 0.01)
    p[57:61], p[118:121], p[180], p[90] = 0.8, 0.6, 0.3, 0.5
    presses = [press(second, second + 0.4) for second in (30.0, 60.0, 90.0)]
    return joined(240, presses, [True, True, False]), p


def at(points: tuple[OperatingPoint, ...], threshold: float) -> OperatingPoint:
    """Return the point of a threshold."""
    return next(point for point in points if point.threshold == threshold)


def test_thresholds_fall_and_recall_rises() -> None:
    """Every threshold at which a press is lost has its row."""
    logs, p = two_minutes()

    points = operating_points(logs, p)

    thresholds = [point.threshold for point in points]
    assert thresholds == sorted(set(thresholds), reverse=True)
    assert {0.8, 0.6, 0.3, 0.01} <= set(thresholds)
    announced = [at(points, one).every.announced for one in (0.8, 0.6, 0.3)]
    seen = [at(points, one).visible.announced for one in (0.8, 0.6, 0.3)]
    assert announced == [1, 2, 3]
    assert seen == [1, 2, 2]
    assert at(points, 0.3).visible.recall == 1
    assert at(points, 0.6).every.median_lead_s == 1.0


def test_a_point_is_what_the_judge_says() -> None:
    """Alarms are those of all scans, leads those of the presses asked for."""
    logs, p = two_minutes()

    point = at(operating_points(logs, p), 0.3)

    alarms = PressJudge(logs.stamps_ns, p, logs.presses).false_alarms(0.3)
    assert alarms.runs == 1
    assert point.every.false_alarms_per_min == 60 / alarms.seconds
    assert point.visible.false_alarms_per_min == point.every.false_alarms_per_min
    assert point.every.alarm_share == pytest.approx(alarms.alarmed_s / alarms.seconds)


def test_the_best_point_has_few_false_alarms() -> None:
    """With fewer allowed, less can be announced."""
    logs, p = two_minutes()
    points = operating_points(logs, p)

    usual, strict = most_recall(points), most_recall(points, 0.1)

    assert usual is not None
    assert strict is not None
    assert (usual.threshold, usual.every.announced) == (0.3, 3)
    assert (strict.threshold, strict.every.announced) == (0.6, 2)
    assert most_recall(points, 0.0) is None
    assert most_recall(()) is None


def test_an_alarm_that_never_ends_is_not_the_best() -> None:
    """It announces every press without one false alarm."""
    logs = joined(240, [press(30, 31), press(90, 91)], [True, True])
    p = np.full(240, 0.5)

    points = operating_points(logs, p)

    assert [point.every.announced for point in points] == [2]
    assert points[0].every.false_alarms_per_min == 0
    assert points[0].every.alarm_share == 1
    assert most_recall(points) is None


def test_logs_do_not_reach_into_each_other() -> None:
    """A run at the end of one log announces nothing at the start of the next."""
    log_index = np.repeat([0, 1, 2], 8)
    stamps_ns = np.tile(np.arange(8) * STEP_NS, 3) + np.repeat([0, 10**18, 500], 8)
    p = np.repeat([0.9, 0.1, 0.9], 8)
    late = Press(10**18 + STEP_NS, 10**18 + 3 * STEP_NS)

    logs = join_logs(log_index, stamps_ns, [(), (late,), None], [(), (True,), ()])
    judge = logs.judge(p)

    assert logs.scans.tolist() == list(range(16))
    assert judge.leads(0.5)[0].predicted is False
    assert judge.false_alarms(0.5).runs == 1
    assert judge.false_alarms(0.5).seconds == pytest.approx(3.5 + 1.0)


def test_a_log_without_scans_keeps_its_presses() -> None:
    """Nobody judges them, and they stay in their place."""
    stamps_ns = np.arange(4) * STEP_NS
    presses = [(press(1, 2),), (press(1.2, 2),)]

    logs = join_logs(np.ones(4, dtype=np.int64), stamps_ns, presses, [(None,), (True,)])

    leads = logs.judge(np.full(4, 0.9)).leads(0.5)
    assert [lead.predicted for lead in leads] == [None, True]
    assert leads[1].lead_s == pytest.approx(1.2)


@pytest.mark.parametrize("presses", [[], [press(0, 1, held=True)]])
def test_without_a_press_to_judge_there_is_no_point(presses: list[Press]) -> None:
    """Nor with probabilities of no model."""
    logs = joined(10, presses, [None] * len(presses))
    judged = joined(10, [press(3, 4)], [True])

    assert operating_points(logs, np.full(10, 0.5)) == ()
    assert operating_points(judged, np.full(10, np.nan)) == ()


def test_many_presses_have_a_bounded_number_of_points() -> None:
    """The table does not grow with the log."""
    p = np.random.default_rng(0).random(4000)
    presses = [press(second, second + 0.2) for second in range(5, 2000, 4)]

    points = operating_points(joined(4000, presses, [True] * len(presses)), p)

    assert 201 <= len(points) <= 302


def test_rows_bear_the_name_of_the_method() -> None:
    """Recall is the share of the judged presses, of all and of the visible ones."""
    names = dict.fromkeys(AucRow.__dataclass_fields__)
    row = AucRow(**{**names, "method": "mpap", "target": "early:1"})  # type: ignore[arg-type]
    logs, p = two_minutes()

    rows = list(operating_rows(row, operating_points(logs, p)))

    found = next(one for one in rows if one.threshold == 0.6)
    assert (found.method, found.target) == ("mpap", "early:1")
    assert (found.presses, found.announced) == (3, 2)
    assert found.recall == pytest.approx(2 / 3)
    assert (found.visible_presses, found.visible_announced, found.visible_recall) == (2, 2, 1)
