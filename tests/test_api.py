"""``import mpap_cli`` costs little and offers the commands as functions."""

import ast
import inspect
import logging
import subprocess
import sys
from pathlib import Path

import pytest

import mpap_cli
from mpap_cli.cli.main import COMMANDS

FIXTURES = Path(__file__).parents[1] / "fixtures"
NO_FUNCTION = {"config", "completion"}


def test_every_command_is_a_function() -> None:
    """Under the name it has on the command line, with a docstring that tells what it raises."""
    names = set(COMMANDS) - NO_FUNCTION

    assert names <= set(mpap_cli.__all__)
    for name in sorted(names):
        function = getattr(mpap_cli, name)
        assert inspect.isfunction(function)
        assert "Raises" in (function.__doc__ or ""), name


def test_everything_offered_is_there_and_typed() -> None:
    """What type checkers see is what there is."""
    tree = ast.parse(Path(mpap_cli.__file__).read_text(encoding="utf-8"))
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    typed = {
        alias.name: node.module
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }

    assert sorted(typed) == sorted(mpap_cli.__all__)
    for name, module in typed.items():
        assert getattr(mpap_cli, name).__module__ == module
    assert set(mpap_cli.__all__) <= set(dir(mpap_cli))


def test_unknown_name() -> None:
    """It is an AttributeError, as of any module."""
    with pytest.raises(AttributeError, match="no attribute 'forget'"):
        _ = mpap_cli.forget


def test_import_alone_loads_nothing_heavy() -> None:
    """Neither numpy nor a reader of logs."""
    words = "import sys, mpap_cli; print({'numpy', 'cv2', 'rosbags', 'click'} & set(sys.modules))"

    said = subprocess.run(  # noqa: S603  # this very Python
        [sys.executable, "-c", words], capture_output=True, text=True, check=True
    )

    assert said.stdout.strip() == "set()"


def test_learn_from_python(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A script learns without anything on stdout; what is said goes through logging."""
    logging.getLogger("mpap_cli").setLevel(logging.WARNING)
    selection = mpap_cli.LogSelection(logs=(str(FIXTURES / "indoor-a.bag"),))

    learnt = mpap_cli.learn(
        selection, mpap_cli.SettingsRequest(), mpap_cli.LearnRequest(out=tmp_path)
    )

    assert learnt.n_presses == 5
    assert max(row.p_collision or 0 for row in learnt.clusters) > 0.1
    assert capsys.readouterr().out == ""
