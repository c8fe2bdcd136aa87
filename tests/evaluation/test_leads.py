"""Leads and false alarms on timelines made by hand; one scan every half second."""

import numpy as np
import pytest

from mpap_cli.evaluation.leads import FalseAlarms, Lead, PressJudge, summarize
from mpap_cli.observations import NS_PER_S, Float64Array, IntArray, Press

MISSED = Lead(False, 0.0)
NOT_JUDGED = Lead(None, None)


def timeline(text: str) -> tuple[IntArray, Float64Array]:
    """Draw a timeline: # predicted, . not, ? no model, space no scan; 0.5 s a sign."""
    place = np.array([i for i, sign in enumerate(text) if sign != " "], dtype=np.int64)
    value = {"#": 0.2, ".": 0.1, "?": np.nan}
    return place * (NS_PER_S // 2), np.array([value[sign] for sign in text if sign != " "])


def press(start_s: float, end_s: float, *, held: bool = False) -> Press:
    """Make a press from seconds."""
    return Press(int(start_s * NS_PER_S), int(end_s * NS_PER_S), held_from_start=held)


@pytest.mark.parametrize(
    ("text", "start_s", "lead"),
    [
        ("...###..", 2.6, Lead(True, 1.1)),
        ("...###..", 2.5, Lead(True, 1.0)),
        ("...#....", 1.5, Lead(True, 0.0)),
        ("...##...", 2.6, MISSED),
        ("##.###..", 2.6, Lead(True, 1.1)),
        ("......##", 2.6, MISSED),
        ("########", 2.6, Lead(True, 2.6)),
        ("##     ####", 4.6, Lead(True, 1.1)),
        ("##   ####", 3.6, Lead(True, 3.6)),
        ("####     .", 4.0, NOT_JUDGED),
        ("...??...", 2.1, NOT_JUDGED),
        ("?###....", 1.6, Lead(True, 1.1)),
        (" ..#", 0.1, NOT_JUDGED),
    ],
)
def test_lead_is_the_length_of_the_run_that_reaches_the_onset(
    text: str, start_s: float, lead: Lead
) -> None:
    """The run counts from its first scan; gaps, pauses and silence end it."""
    stamps_ns, p = timeline(text)

    found = PressJudge(stamps_ns, p, [press(start_s, start_s + 1)]).leads(0.2)

    assert found[0].predicted == lead.predicted
    assert found[0].lead_s == pytest.approx(lead.lead_s)


def test_press_held_from_the_start_is_not_judged() -> None:
    """Nothing can announce a press that is on when the log begins."""
    stamps_ns, p = timeline("####")

    found = PressJudge(stamps_ns, p, [press(0, 1, held=True)]).leads(0.2)

    assert found == [NOT_JUDGED]


@pytest.mark.parametrize(
    ("text", "runs", "seconds"),
    [
        ("....................", 0, 6.0),
        ("##.##...............", 2, 6.0),
        ("......###...........", 0, 6.0),
        ("....................##", 1, 7.0),
        (".................#..", 1, 6.0),
        ("??????????????????.#", 1, 0.5),
        ("###     ###", 1, 1.0),
    ],
)
def test_false_alarms_are_runs_outside_contact(text: str, runs: int, seconds: float) -> None:
    """A run that touches the second around the press (4 s to 5 s) is no false alarm."""
    stamps_ns, p = timeline(text)

    found = PressJudge(stamps_ns, p, [press(4, 5)]).false_alarms(0.2)

    assert (found.runs, found.seconds) == (runs, seconds)


@pytest.mark.parametrize(
    ("text", "alarmed_s"),
    [
        ("....................", 0.0),
        ("##..................", 1.0),
        ("#######.............", 2.5),
        ("####################", 6.0),
        ("###     ###", 1.0),
    ],
)
def test_an_alarm_that_never_ends_takes_all_the_time(text: str, alarmed_s: float) -> None:
    """Runs into a contact (4 s to 5 s) are no false alarms, but alarmed time outside of it."""
    stamps_ns, p = timeline(text)

    found = PressJudge(stamps_ns, p, [press(4, 5)]).false_alarms(0.2)

    assert found.alarmed_s == pytest.approx(alarmed_s)


def test_a_press_is_announced_up_to_the_probability_at_its_onset() -> None:
    """Presses that cannot be judged have none."""
    stamps_ns, p = timeline("..#.?...")
    presses = [press(1.1, 1.2), press(2.1, 2.2), press(3.6, 3.8)]

    found = PressJudge(stamps_ns, p, presses).p_at_presses

    assert found.tolist() == [0.2, 0.1]


def test_summary_counts_a_missed_press_as_zero_seconds() -> None:
    """Median over judged presses, missed ones at 0 s; alarms over all logs' minutes."""
    leads = [Lead(True, 0.8), MISSED, Lead(True, 0.4), NOT_JUDGED]

    found = summarize(leads, [FalseAlarms(1, 20.0, 1.0), FalseAlarms(2, 40.0, 5.0)])

    assert (found.announced, found.judged) == (2, 3)
    assert found.median_lead_s == 0.4
    assert found.false_alarms_per_min == 3
    assert found.alarm_share == pytest.approx(0.1)
    assert found.recall == pytest.approx(2 / 3)


def test_summary_of_nothing_is_empty() -> None:
    """No press and no time: no median and no rate."""
    found = summarize([], [])

    assert found.median_lead_s is None
    assert found.false_alarms_per_min is None
    assert found.alarm_share is None
    assert found.recall is None
