"""A sweep scores one setting at several values."""

from collections.abc import Callable

import pytest

from mpap_cli.errors import SettingError, UsageError
from mpap_cli.evaluation.scoring import evaluate_all
from mpap_cli.evaluation.sheets import Question
from mpap_cli.evaluation.sweep import Sweep, parse_sweep, sweep_variants
from mpap_cli.observations import ObservedLog
from mpap_cli.params import Settings

MakeLog = Callable[..., ObservedLog]


def test_sweep_has_a_row_for_each_value(make_log: MakeLog, settings: Settings) -> None:
    """Rows are named after key and value; a larger theta gives fewer meta-points."""
    question = Question(logs=(make_log(n_cycles=2),))
    variants = sweep_variants(settings, parse_sweep("theta=0.05, 0.3"))

    found = evaluate_all(question, variants, baselines=False).marks

    assert [one.row.method for one in found] == ["mpap theta=0.05", "mpap theta=0.3"]
    first, second = (one.row.meta_points for one in found)
    assert first is not None
    assert second is not None
    assert first > second


def test_sweep_changes_one_setting(settings: Settings) -> None:
    """Everything else stays as it was, the profile too."""
    (variant,) = sweep_variants(settings, Sweep("bins", ("6",)))

    assert variant.settings.scan.bins == 6
    assert variant.settings.profile == settings.profile
    assert variant.settings.meta_point == settings.meta_point
    assert variant.settings.evaluation == settings.evaluation


@pytest.mark.parametrize("text", ["theta", "theta=", "=1,2", "theta=0.1,,0.2"])
def test_sweep_needs_a_key_and_values(text: str) -> None:
    """The message shows the form."""
    with pytest.raises(UsageError, match="expected KEY=V1,V2"):
        parse_sweep(text)


def test_sweep_refuses_what_cannot_vary(settings: Settings) -> None:
    """An unknown key, a value of the wrong kind."""
    with pytest.raises(SettingError, match="no such setting"):
        sweep_variants(settings, Sweep("thetta", ("1",)))
    with pytest.raises(SettingError, match="expected float"):
        sweep_variants(settings, Sweep("theta", ("near",)))


def test_a_sweep_without_end_is_refused() -> None:
    """A hundred values are enough; what was typed is not repeated whole."""
    assert len(parse_sweep("theta=" + ",".join(["0.1"] * 100)).values) == 100
    with pytest.raises(UsageError, match="found 101 values, expected 100 at most"):
        parse_sweep("theta=" + ",".join(["0.1"] * 101))
    with pytest.raises(UsageError, match="expected KEY=V1") as caught:
        parse_sweep("theta=" + "," * 100_000)
    assert len(str(caught.value)) < 300
