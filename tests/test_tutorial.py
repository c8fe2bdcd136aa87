"""The tutorial works as it stands, and shows what the commands print."""

import pytest

from tests.pages import ROOT, Run, check_page, is_shown, run_command

__all__ = ["run_command"]


@pytest.mark.slow
def test_tutorial(run_command: Run) -> None:
    """Each command prints what stands below it."""
    assert check_page(ROOT / "docs" / "tutorial.md", run_command) == []


def test_an_output_that_changes_is_found() -> None:
    """Another figure, a line more, a line less; what is left out may be anything."""
    assert is_shown("a 1\nb 2\n", "a 1\nb 2\n")
    assert is_shown("a 1\nx\ny\nb 2\n", "a 1\n...\nb 2\n")
    assert not is_shown("a 1\nb 3\n", "a 1\nb 2\n")
    assert not is_shown("a 1\nb 2\nc\n", "a 1\nb 2\n")
    assert not is_shown("a 1\n", "a 1\nb 2\n")
    assert not is_shown("a 1\nx\nb 3\n", "a 1\n...\nb 2\n")
