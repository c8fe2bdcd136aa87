"""The how-to pages work as they stand, and show what the commands print."""

import re
from pathlib import Path

import pytest

from tests.pages import ROOT, Run, check_page, run_command

__all__ = ["run_command"]

PAGES = sorted((ROOT / "docs" / "how-to").glob("*.md"))


@pytest.mark.slow
@pytest.mark.parametrize("page", [pytest.param(page, id=page.stem) for page in PAGES])
def test_how_to(page: Path, run_command: Run) -> None:
    """Each command prints what stands below it; a script that a page shows is there to run."""
    text = page.read_text(encoding="utf-8")
    for name, script in re.findall(r"```python\n# (\w+\.py)\n(.*?)```", text, re.DOTALL):
        Path(name).write_text(script, encoding="utf-8")

    assert check_page(page, run_command) == []
