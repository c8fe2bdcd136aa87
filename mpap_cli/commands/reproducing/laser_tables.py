"""Table 4 and the numbers beside it (section 5.2)."""

from collections.abc import Callable, Mapping
from operator import attrgetter

from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.laser_logs import PLACES, TRUTH
from mpap_cli.commands.reproducing.laser_marks import BINS, KEYS, Key, PlaceMarks, SceneMarks
from mpap_cli.evaluation.marks import Marks
from mpap_cli.evaluation.paper_tables import TABLE_4
from mpap_cli.evaluation.rows import AucRow

FEATURE_WORDS = {
    "min-value": "Min-value",
    "max-value": "Max-value",
    "mean-value": "Mean-value",
    "global-diff": "Global difference",
    "seq-diff": "Sequential difference",
}
OTHER_WORDS = {
    "nearest-range": "nearest range ahead, nothing learnt",
    "nearest-range-1s": "nearest range of the last second, nothing learnt",
}
IN_SAMPLE, HELD_OUT, COMPARED = "in-sample", "held out", "held out, other methods"
INTERVALS, DATA = "held out, 95 % intervals", "data"
_NOTES = {
    IN_SAMPLE: (
        "Area under the ROC curve. In-sample: the same scans are learnt and scored, as the "
        "paper seems to have done; only this compares with its numbers."
    ),
    HELD_OUT: (
        "Held out: every scan is scored by a model that has seen neither it nor its press. "
        "The paper has no such numbers."
    ),
    COMPARED: "The same scans, truth and folds; the methods are those of `mpap evaluate`.",
}


def write_tables(bench: Bench, marks: Mapping[str, PlaceMarks]) -> None:
    """Write table 4 in-sample and held out, with the other methods and the sizes of the data."""
    for part, by_key in ((IN_SAMPLE, attrgetter("in_sample")), (HELD_OUT, attrgetter("held_out"))):
        for place, found in marks.items():
            for bins in BINS:
                for feature, words in FEATURE_WORDS.items():
                    key = (feature, bins)
                    paper = TABLE_4[key][PLACES.index(place)] if part == IN_SAMPLE else None
                    bench.number(
                        "table-4",
                        words,
                        f"{place}, {bins} bins",
                        found.areas(_of(by_key, key)),
                        paper=paper,
                        part=part,
                        note=_NOTES[part],
                    )
    for place, found in marks.items():
        for method in found.scenes[0].others:
            areas = [one.others[method].row.auc for one in found.scenes]
            words = OTHER_WORDS.get(method, method)
            bench.number("table-4", words, place, areas, part=COMPARED, note=_NOTES[COMPARED])
    for place, found in marks.items():
        _write_intervals(bench, place, found)
        _write_sizes(bench, place, found)


def _of(
    by_key: Callable[[SceneMarks], dict[Key, Marks]], key: Key
) -> Callable[[SceneMarks], Marks]:
    """Return what picks the marks of one setting."""
    return lambda scene: by_key(scene)[key]


def _write_intervals(bench: Bench, place: str, found: PlaceMarks) -> None:
    """Write the intervals of logs that are not repeated."""
    if found.scenes[0].in_sample[KEYS[0]].row.truth == TRUTH:
        return
    for (feature, bins), one in found.scenes[0].held_out.items():
        for end, value in (("from", one.row.auc_low), ("to", one.row.auc_high)):
            if value is not None:
                quantity = f"{place}, {bins} bins, {end}"
                bench.number("table-4", FEATURE_WORDS[feature], quantity, value, part=INTERVALS)


def _write_sizes(bench: Bench, place: str, found: PlaceMarks) -> None:
    """Write how much there was to learn and to score."""
    rows: list[AucRow] = [next(iter(one.held_out.values())).row for one in found.scenes]
    simulated = rows[0].truth == TRUTH
    note = (
        "Learnt from the bumper, scored against every contact of the simulation, also those "
        "that bumper or laser miss; a repeat is a world of its own."
        if simulated
        else f"Scored against the presses of the {rows[0].truth}; held out: {rows[0].protocol}."
    )
    columns: tuple[tuple[str, list[float | None]], ...] = (
        ("logs", [row.logs for row in rows]),
        ("scans", [row.positives + row.negatives for row in rows]),
        ("in contact", [row.positives for row in rows]),
        ("contacts", [row.presses for row in rows]),
        ("beams without return in contact (%)", [one.lost[0] for one in found.scenes]),
        ("otherwise (%)", [one.lost[1] for one in found.scenes]),
    )
    for quantity, values in columns:
        bench.number("table-4", place, quantity, values, part=DATA, note=note)
