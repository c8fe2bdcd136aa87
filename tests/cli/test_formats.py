"""What programs read: CSV and JSON on stdout and nothing beside them, and tables in files."""

import csv
import io
import json
from pathlib import Path

import pytest

from docs.columns_page import PRINTED, TABLES, meanings, settings_keys
from mpap_cli.cli.main import COMMANDS
from mpap_cli.commands.describing.facts import (
    BumpFacts,
    LogFacts,
    ModelFacts,
    ModelLogFacts,
    ScanFacts,
    TopicFacts,
)
from mpap_cli.outputs.results_record import InputFile
from tests.commands.patch_sets import arrays, write_npz
from tests.commands.running import BAG, FIXTURES, MCAP, done, record_of

CAMERA = FIXTURES / "camera-a.mcap"
PATCHES = "{out}/patches.npz"
WORDS: dict[str, tuple[object, ...]] = {
    "info": (BAG,),
    "learn": (BAG, "--end", 40, "-o", "{out}"),
    "info MODEL": ("{out}",),
    "evaluate": ("-o", "{out}"),
    "learn --merge": (BAG, MCAP, "--jobs", 1, "-o", "{out}/fleet"),
    "learn --sensor": ("image", CAMERA, "--end", 4, "-o", "{out}/camera"),
    "predict": ("{out}", MCAP, "-o", "{out}"),
    "predict --sensor": ("image", "{out}/camera", CAMERA, "--end", 4, "-o", "{out}/camera"),
    "novelty": (CAMERA, "--end", 6, "-o", "{out}"),
    "similar": ("{out}", "--at", f"{MCAP}@30", "-o", "{out}"),
    "compare": (BAG, MCAP, "-o", "{out}"),
    "extract": (BAG, "--presses", "-o", "{out}"),
    "extract --dry-run": (BAG, "--presses", "-o", "{out}"),
    "merge": ("{out}", "-o", "{out}"),
    "cluster": (PATCHES, "--orders", 1, "--method", "k-means", "-o", "{out}"),
    "reproduce": ("--only", "table-2", "--textures", PATCHES, "--seeds", 1, "-o", "{out}"),
    "simulate": ("{out}/{shape}/LOG", "--duration", 3, "--camera", "--image-size", "160x120"),
    "config": (),
}
Printed = dict[tuple[str, str], str]


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a results folder."""
    folder = tmp_path_factory.mktemp("formats")
    write_npz(folder / "patches.npz", **arrays(8))
    return folder


@pytest.fixture(scope="module")
def printed(out: Path) -> Printed:
    """Run every command in both shapes and return what each prints."""
    found = {}
    for shape in ("csv", "json"):
        (out / shape).mkdir()
        for name, words in WORDS.items():
            filled = [str(word).format(out=out, shape=shape) for word in words]
            command = name.removesuffix(" MODEL").split()
            found[name, shape] = done(*command, *filled, "--format", shape).out
    return found


def test_every_command_is_asked() -> None:
    """Only the completion script is no table."""
    assert {name.split()[0] for name in WORDS} == set(COMMANDS) - {"completion"}


@pytest.mark.slow
@pytest.mark.parametrize("name", list(WORDS))
def test_csv_and_json_hold_the_same_keys(printed: Printed, name: str) -> None:
    """Both are whole and alone on stdout; the rows of one are the objects of the other."""
    rows = list(csv.reader(io.StringIO(printed[name, "csv"]), strict=True))
    found = json.loads(printed[name, "json"])

    objects = found if isinstance(found, list) else [found]
    assert len(rows) > 1
    assert {len(row) for row in rows} == {len(rows[0])}
    if not name.startswith("info"):
        assert [list(one) for one in objects] == [rows[0]] * (len(rows) - 1)


@pytest.mark.slow
def test_every_table_has_the_documented_columns(printed: Printed, out: Path) -> None:
    """No table is missing on the page, none has a column more or less or in another place."""
    assert printed
    known = {one.file: list(meanings(one.columns)) for one in TABLES}

    tables = {path: path.read_text("utf-8").partition("\n")[0] for path in out.rglob("*.csv")}

    names = {path: "leaves/" * (path.parent.name == "leaves") + path.name for path in tables}
    assert set(names.values()) == set(known)
    for path, head in tables.items():
        assert head.split(",") == known[names[path]], path


@pytest.mark.slow
def test_what_is_printed_has_the_documented_columns(printed: Printed) -> None:
    """Also where no file holds the same rows."""
    words = {"info LOG": "info", "info MODEL": "info MODEL"}

    for table in PRINTED:
        name = table.file.removesuffix(" --format csv")
        head = printed[words.get(name, name), "csv"].partition("\n")[0]

        assert head.split(",") == list(meanings(table.columns)), name


@pytest.mark.slow
def test_the_keys_of_info_are_documented(printed: Printed) -> None:
    """Those of a log, its topics, bumper and scans, and those of a model, in their order."""
    (log,), (model,) = (json.loads(printed[name, "json"]) for name in ("info", "info MODEL"))

    assert list(log) == list(meanings(LogFacts))
    assert list(log["topics"][0]) == list(meanings(TopicFacts))
    assert list(log["bump"]) == list(meanings(BumpFacts))
    assert list(log["scan"]) == list(meanings(ScanFacts))
    assert list(model) == list(meanings(ModelFacts))
    assert list(model["logs"][0]) == list(meanings(ModelLogFacts))


@pytest.mark.slow
def test_the_keys_of_settings_json_are_documented(printed: Printed, out: Path) -> None:
    """Every one, and no other."""
    assert printed

    record = record_of(out / "learn")

    assert list(record) == list(settings_keys())
    assert list(record["inputs"][0]) == list(meanings(InputFile))
