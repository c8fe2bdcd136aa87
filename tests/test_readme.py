"""What the README shows is what the commands print."""

import re
from pathlib import Path

import pytest

from mpap_cli.cli.main import main

ROOT = Path(__file__).parent.parent


def readme_block() -> list[str]:
    """Return the lines of the first block of output in the README."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    found = re.search(r"```text\n(.*?)```", text, re.DOTALL)
    assert found is not None
    return found[1].splitlines()


@pytest.mark.slow
def test_the_readme_shows_true_output(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each command of the first block prints the lines that stand below it."""
    monkeypatch.setenv("MPAP_OUT", str(tmp_path))
    monkeypatch.chdir(ROOT)
    printed: list[str] = []

    for line in readme_block():
        if line.startswith("$ mpap "):
            with pytest.raises(SystemExit):
                main(line.removeprefix("$ mpap ").split())
            printed = capsys.readouterr().out.splitlines()
        else:
            assert line in printed


def test_the_links_of_the_documents_lead_somewhere() -> None:
    """Every relative link in a Markdown file names a file that is there."""
    pages = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]

    links = [
        (page, link)
        for page in pages
        for link in re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8"))
    ]

    assert len(links) > 3
    assert [(page.name, link) for page, link in links if not (page.parent / link).exists()] == []
