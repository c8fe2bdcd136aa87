"""The page of all tables, from the rows in the code."""

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

from mpap_cli.cli.info_text import TopicRow
from mpap_cli.cli.model_text import ModelRow
from mpap_cli.cli.predicted_text import PredictedRow
from mpap_cli.cli.simulated_text import SimulatedRow
from mpap_cli.commands.describing.facts import (
    BumpFacts,
    ImageFacts,
    LogFacts,
    ModelFacts,
    ModelLogFacts,
    ScanFacts,
    TopicFacts,
)
from mpap_cli.commands.extracting.cutting import SegmentRow
from mpap_cli.commands.fleet.manifest import ManifestRow
from mpap_cli.commands.settings import SettingRow
from mpap_cli.evaluation.clusterers.scores import ClusteringRow
from mpap_cli.evaluation.comparing import CompareRow
from mpap_cli.evaluation.novelty import NoveltyRow
from mpap_cli.evaluation.remembering import SimilarRow
from mpap_cli.evaluation.reproduced import ReproducedRow
from mpap_cli.evaluation.rows import (
    AucRow,
    DecisionRow,
    DifferenceRow,
    OperatingRow,
    PatchRow,
    PressRow,
    RocRow,
    TimelineRow,
)
from mpap_cli.outputs.results_record import InputFile, Results
from mpap_cli.simulation.camera_truth import IMAGE_COLUMNS, PATCH_COLUMNS
from mpap_cli.simulation.scenario import CONTACT_COLUMNS
from mpap_cli.systems.cluster_rows import ClusterRow

HEAD = """# Tables and their columns

This page is written from the rows in the code by `make docs`.

Tables are CSV in UTF-8 with one header line; `--format csv` and `--format json` print rows of the
same kind. An empty cell (`null` in JSON) says that there is no such number; flags are 1 and 0;
floats have the digits they need to come back unchanged. Every command writes into
`OUT/<command>/`. What the scores mean: [numbers.md](numbers.md).

"""


class Table(NamedTuple):
    """One table: its file, the commands that write or print it, what a row is, its columns."""

    file: str
    commands: tuple[str, ...]
    row: str
    columns: Any


TABLES = (
    Table("clusters.csv", ("learn", "evaluate", "merge"), "a cluster", ClusterRow),
    Table("leaves/manifest.csv", ("learn --merge",), "a log", ManifestRow),
    Table("auc.csv", ("evaluate",), "a method", AucRow),
    Table("differences.csv", ("evaluate",), "the first method against another", DifferenceRow),
    Table("operating.csv", ("evaluate",), "a threshold of a method", OperatingRow),
    Table("roc.csv", ("evaluate",), "a corner of the ROC curve of a method", RocRow),
    Table("timeline.csv", ("evaluate", "predict"), "a scan", TimelineRow),
    Table("presses.csv", ("evaluate", "predict"), "a press", PressRow),
    Table("decisions.csv", ("predict",), "an image", DecisionRow),
    Table("patches.csv", ("predict",), "a patch of an image", PatchRow),
    Table("novelty.csv", ("novelty",), "a window of a log", NoveltyRow),
    Table("compare.csv", ("compare",), "a log against another, or all others", CompareRow),
    Table("similar.csv", ("similar",), "an earlier moment, the nearest first", SimilarRow),
    Table("segments.csv", ("extract",), "a segment", SegmentRow),
    Table("cluster.csv", ("cluster",), "a run of a clusterer", ClusteringRow),
    Table("reproduced.csv", ("reproduce",), "a number of the paper", ReproducedRow),
    Table("LOG.truth.csv", ("simulate",), "a contact", CONTACT_COLUMNS),
    Table("LOG.patches.csv", ("simulate --camera",), "a patch of an image", PATCH_COLUMNS),
    Table("LOG.images.csv", ("simulate --camera",), "an image", IMAGE_COLUMNS),
)
PRINTED = (
    Table("info LOG --format csv", (), "a topic of a log", TopicRow),
    Table("info MODEL --format csv", (), "a log that a model has learnt", ModelRow),
    Table("predict --format csv", (), "all that was predicted", PredictedRow),
    Table("simulate --format csv", (), "the log that was written", SimulatedRow),
    Table("config --format csv", (), "a setting", SettingRow),
)
_INFO = {
    "A log": LogFacts,
    "`topics`": TopicFacts,
    "`bump`": BumpFacts,
    "`scan`": ScanFacts,
    "`image`": ImageFacts,
    "A model": ModelFacts,
    "`logs` of a model": ModelLogFacts,
}


def meanings(columns: Any) -> dict[str, str]:
    """Return columns or keys with their meanings.

    Parameters
    ----------
    columns : type or mapping
        A row's dataclass or a TypedDict whose types are annotated, or the meanings.

    Raises
    ------
    ValueError
        If a column has no meaning.
    """
    if isinstance(columns, dict):
        return dict(columns)
    hints = get_type_hints(columns, include_extras=True)
    names = [item.name for item in fields(columns)] if is_dataclass(columns) else list(hints)
    found = {}
    for name in names:
        if get_origin(hints[name]) is not Annotated:
            msg = f"{columns.__name__}.{name}: has no meaning; write Annotated[type, meaning]"
            raise ValueError(msg)
        found[name] = get_args(hints[name])[1]
    return found


def _lines(columns: Mapping[str, str], what: str = "column") -> Iterator[str]:
    """Yield a table of Markdown."""
    yield f"| {what} | meaning |\n| --- | --- |\n"
    for name, meaning in columns.items():
        yield f"| {name} | {meaning.replace('|', chr(92) + '|')} |\n"
    yield "\n"


def column_lines() -> Iterator[str]:
    """Yield the page."""
    yield HEAD
    yield "| table | of | one row is |\n| --- | --- | --- |\n"
    for one in TABLES:
        commands = ", ".join(f"`{name}`" for name in one.commands)
        yield f"| [{one.file}](#{anchor(one.file)}) | {commands} | {one.row} |\n"
    yield "\n"
    for one in TABLES:
        yield f"## {one.file}\n\n"
        yield from _lines(meanings(one.columns))
    yield "# What is printed only\n\n"
    for one in PRINTED:
        yield f"## {one.file}\n\nOne row is {one.row}.\n\n"
        yield from _lines(meanings(one.columns))
    yield "## info --format json\n\nA list of logs and models, keys in this order.\n\n"
    for title, kind in _INFO.items():
        yield f"{title}:\n\n"
        yield from _lines(meanings(kind), "key")
    yield "## settings.json\n\nBeside the results of every command.\n\n"
    yield from _lines(settings_keys(), "key")
    yield "Each of `inputs`:\n\n"
    yield from _lines(meanings(InputFile), "key")


def settings_keys() -> dict[str, str]:
    """Return the keys of settings.json: all that has a meaning."""
    hints = get_type_hints(Results, include_extras=True)
    return {
        name: get_args(hint)[1] for name, hint in hints.items() if get_origin(hint) is Annotated
    }


def anchor(title: str) -> str:
    """Return the anchor of a heading, as GitHub makes it.

    >>> anchor("leaves/manifest.csv")
    'leavesmanifestcsv'
    """
    kept = (letter for letter in title.lower() if letter.isalnum() or letter in "-_ ")
    return "".join(kept).replace(" ", "-")
