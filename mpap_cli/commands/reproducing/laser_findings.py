"""What the paper claims of its features (section 5.2), held against the numbers of this run."""

from collections.abc import Mapping
from itertools import product

from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.laser_curves import height_at, marks_of
from mpap_cli.commands.reproducing.laser_logs import PLACES
from mpap_cli.commands.reproducing.laser_marks import BINS, ROBUST, PlaceMarks
from mpap_cli.commands.reproducing.laser_tables import FEATURE_WORDS
from mpap_cli.evaluation.paper_tables import TABLE_4
from mpap_cli.evaluation.reproduced import spread

_BEST = ("global-diff", "max-value")
_LEVEL = 0.02
_USEFUL = 0.6
_HELD = f"one of them is best here, or within {_LEVEL:g} of the best,"
_OTHERS = "another is better"
_NOTHING = f"no feature reaches {_USEFUL:g}"
_LOW_FPR = 0.1
Areas = dict[tuple[str, str, int], float]
"""Mean area by feature, place and bins."""


def tell_findings(bench: Bench, marks: Mapping[str, PlaceMarks]) -> None:
    """Say which of the claims of section 5.2 hold here, and where."""
    seen, unseen = _areas(marks, in_sample=True), _areas(marks, in_sample=False)
    for areas, protocol in ((seen, "in-sample"), (unseen, "held out")):
        if areas:
            _tell_best(bench, areas, protocol)
            _tell_bins(bench, areas, protocol)
    _tell_loss(bench, seen, unseen)
    _tell_others(bench, marks)
    _tell_returns(bench, marks, seen)
    _tell_low_rates(bench, marks)


def _areas(marks: Mapping[str, PlaceMarks], *, in_sample: bool) -> Areas:
    """Return the mean areas, those that there are."""
    found: Areas = {}
    for feature, (place, of_place), bins in product(FEATURE_WORDS, marks.items(), BINS):
        rows = [one.row for one in marks_of(of_place, (feature, bins), in_sample=in_sample)]
        mean = spread([row.auc for row in rows]).mean
        if mean is not None:
            found[feature, place, bins] = mean
    return found


def _tell_best(bench: Bench, areas: Areas, protocol: str) -> None:
    """Say where global difference and maximum do best, as the paper says of them."""
    groups: dict[str, list[str]] = {_HELD: [], _OTHERS: [], _NOTHING: []}
    for place, bins in sorted({(place, bins) for _, place, bins in areas}):
        column = {key[0]: area for key, area in areas.items() if key[1:] == (place, bins)}
        best = max(column, key=lambda feature: column[feature])
        near = any(column.get(name, 0.0) >= column[best] - _LEVEL for name in _BEST)
        shown = [f"{name} {column[name]:.2f}" for name in _BEST if name in column and name != best]
        parts = (f"{best} {column[best]:.2f}", ", ".join(shown))
        words = "; ".join(part for part in parts if part)
        group = _NOTHING if column[best] < _USEFUL else _HELD if near else _OTHERS
        groups[group].append(f"{place} with {bins} bins ({words})")
    told = [f"{words} {', '.join(found)}" for words, found in groups.items() if found]
    bench.finding(
        "table-4",
        f"The paper finds global difference and maximum best. {protocol.capitalize()}, "
        f"{'; '.join(told)}.",
    )


def _tell_bins(bench: Bench, areas: Areas, protocol: str) -> None:
    """Say whether six bins are better than twelve."""
    printed = {
        (feature, place, bins): area
        for (feature, bins), of_places in TABLE_4.items()
        for place, area in zip(PLACES, of_places, strict=True)
    }
    here = _six_against_twelve(areas)
    if here:
        bench.finding(
            "table-4",
            f'"Slightly better performance when using only six bins": {protocol} here '
            f"{here}; by the paper's Table 4 {_six_against_twelve(printed)}.",
        )


def _six_against_twelve(areas: Areas) -> str:
    """Say how often and by how much six bins are better; "" where there is no pair."""
    six, twelve = BINS
    pairs = [
        (area, areas[feature, place, twelve])
        for (feature, place, bins), area in areas.items()
        if bins == six and (feature, place, twelve) in areas
    ]
    if not pairs:
        return ""
    better = sum(few > many for few, many in pairs)
    gain = sum(few - many for few, many in pairs) / len(pairs)
    return f"six bins are better in {better} of {len(pairs)} pairs, by {gain:+.2f} on average"


def _tell_loss(bench: Bench, seen: Areas, unseen: Areas) -> None:
    """Say how much of the in-sample area is left where the scans were held out."""
    both = sorted(seen.keys() & unseen.keys())
    if not both:
        return
    loss = sum(seen[key] - unseen[key] for key in both) / len(both)
    low = min(unseen[key] for key in both)
    high = max(unseen[key] for key in both)
    bench.finding(
        "table-4",
        f"Holding scans out costs the paper's features {loss:.2f} of area on average; what is "
        f"left lies between {low:.2f} and {high:.2f}.",
    )


def _tell_others(bench: Bench, marks: Mapping[str, PlaceMarks]) -> None:
    """Say what the robust profile and the nearest range reach on the same scans."""
    for place, found in marks.items():
        areas = {
            method: spread([one.others[method].row.auc for one in found.scenes]).mean
            for method in (ROBUST, "nearest-range")
        }
        robust, nearest = areas.values()
        if robust is not None and nearest is not None:
            bench.finding(
                "table-4",
                f"Held out {place}: profile robust {robust:.2f}, the nearest range ahead, for "
                f"which nothing is learnt, {nearest:.2f}.",
            )


def _tell_returns(bench: Bench, marks: Mapping[str, PlaceMarks], seen: Areas) -> None:
    """Say whether what the paper gives as the reason for max-value is there."""
    for place, found in marks.items():
        in_contact, otherwise = (
            spread([one.lost[index] for one in found.scenes]).mean for index in range(2)
        )
        area = seen.get(("max-value", place, BINS[0]))
        if in_contact is None or otherwise is None or area is None:
            continue
        bench.finding(
            "table-4",
            "The paper explains max-value by the many maximum-range readings in collisions, "
            f"which come from where its scanner sits. Here {place}, {in_contact:.0f} % of the "
            f"beams have no return in contact, {otherwise:.0f} % otherwise, and max-value "
            f"reaches {area:.2f} with six bins in-sample.",
        )


def _tell_low_rates(bench: Bench, marks: Mapping[str, PlaceMarks]) -> None:
    """Compare the features where there are few false alarms, as the text does."""
    for place, found in marks.items():
        heights = {
            feature: height_at(marks_of(found, (feature, BINS[0]), in_sample=True), _LOW_FPR)
            for feature in FEATURE_WORDS
        }
        known = {feature: height for feature, height in heights.items() if height is not None}
        if known:
            ranked = sorted(known, key=lambda feature: -known[feature])
            words = ", ".join(f"{feature} {known[feature]:.2f}" for feature in ranked)
            bench.finding(
                "figure-10",
                "The paper: max-value and global difference are good at a much lower false "
                f"positive rate than min-value. Here {place}, in-sample with six bins, the true "
                f"positive rate at a false positive rate of {_LOW_FPR:g} is: {words}.",
            )
