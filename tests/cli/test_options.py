"""Options are offered where they count, with the choices that the code behind them knows."""

from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import click
import pytest

from mpap_cli.cli.evaluate import PROTOCOLS as PROTOCOLS_OFFERED
from mpap_cli.cli.main import mpap
from mpap_cli.cli.options import FEATURES
from mpap_cli.cli.simulate import CONTAINERS as CONTAINERS_OFFERED
from mpap_cli.cli.simulate import WORLDS
from mpap_cli.commands.inputs.selection import OPTIONS, LogSelection
from mpap_cli.evaluation.protocols import PROTOCOLS
from mpap_cli.logs.writing.storages import CONTAINERS
from mpap_cli.params import PAPER_FEATURES
from mpap_cli.simulation.settings import PLACES


def options_of(name: str) -> set[str]:
    """Return the options of a command."""
    command = mpap.get_command(click.Context(mpap), name)
    assert command is not None
    return {word for one in command.params for word in one.opts}


def test_choices_are_those_of_the_code() -> None:
    """What is copied so that help starts fast does not fall behind."""
    assert set(PROTOCOLS_OFFERED) == set(PROTOCOLS) - {"given-model"}
    assert set(CONTAINERS_OFFERED) == set(CONTAINERS)
    assert set(WORLDS) == set(PLACES)
    assert set(FEATURES) == {*PAPER_FEATURES, "seq-diff-signed"}


def test_every_field_of_the_selection_has_its_option() -> None:
    """What can be said of logs has a name on the command line."""
    assert set(OPTIONS) == {item.name for item in fields(LogSelection)} - {"logs", "sensor", "once"}
    for command in ("info", "learn", "evaluate", "predict"):
        assert set(OPTIONS.values()) <= options_of(command)


def test_options_said_are_those_that_differ() -> None:
    """A selection that says nothing but its logs has said no option."""
    assert LogSelection(logs=("a.bag",)).options_said == ()
    assert LogSelection(end="3", forward="90", strict=True).options_said == (
        "--forward",
        "--end",
        "--strict",
    )


@pytest.mark.parametrize("option", ["--fov", "--max-range"])
def test_what_a_model_sees_is_asked_where_models_are_made(
    run: Callable[..., Any], option: str
) -> None:
    """Field of view and cap on ranges belong to learn and evaluate, not to predict and info."""
    assert {option} <= options_of("learn") & options_of("evaluate")

    for words in (("info", "log.bag"), ("predict", "model.npz", "log.bag")):
        outcome = run(*words, option, "3")

        assert outcome.code == 2
        assert option in outcome.err


@pytest.mark.parametrize(
    "words",
    [
        ("--scan-topic", "/scan"),
        ("--bump-from", "none"),
        ("--bump-distance", "0.3"),
        ("--forward", "90"),
        ("--start", "5"),
        ("--time-source", "header"),
        ("--strict",),
    ],
)
def test_evaluate_without_logs_refuses_what_speaks_of_logs(
    tmp_path: Path, run: Callable[..., Any], words: tuple[str, ...]
) -> None:
    """The first option that cannot count is named."""
    outcome = run("evaluate", *words, "-o", tmp_path / "out")

    assert outcome.code == 2
    assert outcome.err.endswith(
        f"{words[0]} needs LOG; without LOG evaluate scores what was learnt\n"
    )
