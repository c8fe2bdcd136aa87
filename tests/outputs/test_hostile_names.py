"""Names that are no valid text, and links in the results folder, do no harm."""

from pathlib import Path

import pytest

from mpap_cli.errors import OutputError
from mpap_cli.outputs.canvas import blank, put_text, shorten
from mpap_cli.outputs.results_folder import ResultsFolder


def save_two(out: Path) -> None:
    """Write two results."""
    with ResultsFolder(out, "learn") as results:
        for name in ("a.csv", "b.csv"):
            results.path(name).write_text(name, encoding="utf-8")
        results.commit({}, [])


def test_a_name_that_is_no_text_can_be_drawn() -> None:
    """Lone surrogates would end the process inside OpenCV."""
    image = blank(200, 40)

    put_text(image, shorten("bad\udcff.bag" * 9, 150, 0.5), (5, 20))

    assert (image < 255).any()


def test_a_link_in_place_of_the_lock_is_not_followed(tmp_path: Path) -> None:
    """Nobody's file is overwritten through the lock."""
    precious = tmp_path / "precious.txt"
    precious.write_text("mine", encoding="utf-8")
    out = tmp_path / "out"
    out.mkdir()
    (out / ".learn.lock").symlink_to(precious)

    with pytest.raises(OutputError), ResultsFolder(out, "learn"):
        pass

    assert precious.read_text(encoding="utf-8") == "mine"


def test_a_folder_in_place_of_a_result_leaves_the_others_alone(tmp_path: Path) -> None:
    """Either all results appear or none."""
    (tmp_path / "learn" / "b.csv").mkdir(parents=True)

    with pytest.raises(OutputError):
        save_two(tmp_path)

    assert [path.name for path in (tmp_path / "learn").iterdir()] == ["b.csv"]
