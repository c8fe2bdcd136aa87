"""What the README shows is what the commands print."""

import re
from pathlib import Path

import pytest

from docs.columns_page import anchor
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


def pages() -> list[Path]:
    """Return every page for readers."""
    return [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]


def links_of(page: Path) -> list[str]:
    """Return the links of a page that lead to files or headings of the project."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    return [link for link in re.findall(r"\]\(([^)\s]+)\)", text) if ":" not in link]


def anchors_of(page: Path) -> set[str]:
    """Return the anchors of the headings of a page."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    return {anchor(title) for title in re.findall(r"^#+ (.*)$", text, re.MULTILINE)}


def test_the_links_of_the_documents_lead_somewhere() -> None:
    """Every relative link in a Markdown file names a file that is there, and a heading in it."""
    links = [(page, *link.partition("#")[::2]) for page in pages() for link in links_of(page)]

    targets = [(page, page.parent / file if file else page, name) for page, file, name in links]

    assert len(links) > 50
    assert [(page.name, str(file)) for page, file, _ in targets if not file.exists()] == []
    named = [(page.name, file, name) for page, file, name in targets if name]
    assert [one for one in named if one[2] not in anchors_of(one[1])] == []


def test_every_page_is_one_click_from_the_readme() -> None:
    """The README links all pages under docs."""
    linked = {(ROOT / link.partition("#")[0]).resolve() for link in links_of(ROOT / "README.md")}

    assert [page.name for page in (ROOT / "docs").rglob("*.md") if page not in linked] == []
