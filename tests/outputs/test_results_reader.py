"""Results are read back whole, or what is wrong with them is named."""

import hashlib
from pathlib import Path

import pytest

from mpap_cli.errors import LogError, OutputError
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import (
    InputFile,
    describe_input,
    has_results,
    read_results,
)
from mpap_cli.outputs.results_record import is_safe_name

SETTINGS = '{"mpap": "", "command": "", "seed": 0, "settings": {}, "inputs": [], "outputs": {}}'


def save(out: Path, texts: dict[str, str], settings: dict[str, str] | None = None) -> Path:
    """Run a command that writes these texts."""
    with ResultsFolder(out, "learn") as results:
        for name, text in texts.items():
            results.path(name).write_text(text)
        results.commit(settings or {}, [InputFile("day1.bag", 3, "ab")], seed=7)
    return results.folder


def test_results_are_read_back(tmp_path: Path) -> None:
    """What was committed is what read_results returns."""
    folder = save(tmp_path, {"clusters.csv": "a\n"}, {"theta": "0.1"})

    results = read_results(folder)

    assert results.settings == {"theta": "0.1"}
    assert results.seed == 7
    assert results.inputs == (InputFile("day1.bag", 3, "ab"),)
    assert results.path("clusters.csv").read_text() == "a\n"
    with pytest.raises(OutputError, match=r"there is no model.npz; run mpap learn"):
        results.path("model.npz")


def test_changed_output_is_named(tmp_path: Path) -> None:
    """An output of another run, or changed by hand, is named."""
    folder = save(tmp_path, {"clusters.csv": "a", "roc.csv": "b"})
    (folder / "roc.csv").write_text("c")

    with pytest.raises(OutputError, match=r"roc.csv is not the file .*run mpap learn again"):
        read_results(folder)


def test_missing_output_is_named(tmp_path: Path) -> None:
    """An output that is gone is named."""
    folder = save(tmp_path, {"clusters.csv": "a"})
    (folder / "clusters.csv").unlink()

    with pytest.raises(OutputError, match=r"clusters.csv is missing"):
        read_results(folder)


def test_unfinished_results_are_told_from_none(tmp_path: Path) -> None:
    """Outputs without settings.json are an unfinished run; an empty place is no run."""
    (tmp_path / "learn").mkdir()
    (tmp_path / "learn" / "clusters.csv").write_text("a")

    with pytest.raises(OutputError, match=r"learn: no settings.json, an unfinished run; run mpap"):
        read_results(tmp_path / "learn")
    with pytest.raises(OutputError, match="evaluate: there are no results; run mpap evaluate"):
        read_results(tmp_path / "evaluate")

    assert not has_results(tmp_path / "learn")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        "[" * 100_000,
        SETTINGS.replace('"mpap": ""', '"mpap": 1'),
        SETTINGS.replace('"settings": {}', '"settings": []'),
        SETTINGS.replace('"outputs": {}', '"outputs": {"../x": ""}'),
        SETTINGS.replace('"inputs": []', '"inputs": [1]'),
    ],
)
def test_garbled_settings_are_named(tmp_path: Path, text: str) -> None:
    """Whatever settings.json holds, it is believed or named; a new run replaces it."""
    folder = save(tmp_path, {"clusters.csv": "a"})
    (folder / "settings.json").write_text(text)

    with pytest.raises(OutputError, match="not the settings of a run"):
        read_results(folder)

    save(tmp_path, {"clusters.csv": "b"})
    assert read_results(folder).path("clusters.csv").read_text() == "b"


def test_settings_that_cannot_be_opened_are_named(tmp_path: Path) -> None:
    """A folder in the place of settings.json is one line."""
    (tmp_path / "settings.json").mkdir()

    with pytest.raises(OutputError, match=r"settings.json: cannot be read"):
        read_results(tmp_path)


def test_input_is_described_wherever_it_lies(tmp_path: Path) -> None:
    """A file and a folder are told by base name, size and content, not by path or date."""
    for place in ("a", "b"):
        folder = tmp_path / place / "day1"
        folder.mkdir(parents=True)
        (folder / "metadata.yaml").write_text("x")
        (folder / "day1_0.db3").write_text("scans")

    first, second = (describe_input(tmp_path / place / "day1") for place in ("a", "b"))
    of_file = describe_input(tmp_path / "a" / "day1" / "day1_0.db3")

    assert first == second
    assert (first.name, first.size) == ("day1", 6)
    assert of_file == InputFile("day1_0.db3", 5, hashlib.sha256(b"scans").hexdigest())


def test_missing_input_is_named(tmp_path: Path) -> None:
    """An input that is gone is one line."""
    with pytest.raises(LogError, match=r"day1.bag: cannot be read \(no such file"):
        describe_input(tmp_path / "day1.bag")


def test_hidden_zero_byte_is_no_safe_name() -> None:
    """A zero byte ends names in the operating system."""
    assert not is_safe_name("a\0b")
