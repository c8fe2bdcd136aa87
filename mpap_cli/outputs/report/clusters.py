"""The section of clusters: what each looks like, how often it was seen, what it meant."""

from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from mpap_cli.errors import ModelError
from mpap_cli.outputs.exemplar_file import (
    EXEMPLARS_NAME,
    Exemplars,
    ScanExemplar,
    read_exemplar_file,
)
from mpap_cli.outputs.report.drawings import color_of, data_uri, scan_svg
from mpap_cli.outputs.report.runs import MOST_SIGNS, Row, Runs, number
from mpap_cli.outputs.scan_views import SeenScan, common_scale

MOST_CARDS = 5000

_NO_EXEMPLARS = Exemplars({}, {})


@dataclass(frozen=True, slots=True)
class Card:
    """One cluster: its numbers, and what its exemplar looks like."""

    sensor: str
    cluster: int
    p: float | None
    p_low: float | None
    p_high: float | None
    observations: int
    presses: int
    color: str
    seen: str
    drawing: Markup | None
    photo: str
    members: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ClusterSection:
    """Cards of one sensor, the most likely collision first."""

    sensor: str
    what: str
    cards: tuple[Card, ...]


def cluster_sections(runs: Runs) -> list[ClusterSection]:
    """Return a section for each sensor that was learnt last."""
    command = "learn" if "learn" in runs.by_command else "merge"
    rows = list(runs.rows(command, "clusters.csv", MOST_CARDS + 1))
    if len(rows) > MOST_CARDS:
        runs.problems.append(f"{command}/clusters.csv: only the first {MOST_CARDS:,} are shown")
        del rows[MOST_CARDS:]
    exemplars = _exemplars(runs)
    top_m = common_scale([_seen(one) for one in exemplars.scans.values()] or [_nothing()])
    found = []
    for sensor, what in (("scan", "laser scans"), ("image", "image patches")):
        cards = [_card(row, exemplars, top_m) for row in rows if row["sensor"] == sensor]
        if cards:
            cards.sort(key=lambda card: -1.0 if card.p is None else card.p, reverse=True)
            found.append(ClusterSection(sensor, what, tuple(cards)))
    return found


def _exemplars(runs: Runs) -> Exemplars:
    path = runs.path("learn", EXEMPLARS_NAME)
    if path is None:
        return _NO_EXEMPLARS
    try:
        return read_exemplar_file(path)
    except ModelError as err:
        runs.problems.append(str(err))
        return _NO_EXEMPLARS


def _seen(scan: ScanExemplar) -> SeenScan:
    return SeenScan(scan.angles.astype(np.float64), scan.ranges.astype(np.float64))


def _nothing() -> SeenScan:
    return SeenScan(np.zeros(0), np.zeros(0))


def _card(row: Row, exemplars: Exemplars, top_m: float) -> Card:
    """Put together what is shown of one cluster."""
    cluster, p = int(row["cluster"]), number(row["p_collision"])
    scan = exemplars.scans.get(cluster) if row["sensor"] == "scan" else None
    pictures = exemplars.patches.get(cluster, ()) if row["sensor"] == "image" else ()
    uris = [data_uri(jpeg) for jpeg in pictures]
    label = f"cluster {cluster}, the scan of its exemplar from above"
    drawing = None if scan is None else scan_svg(scan.angles, scan.ranges, top_m, label)
    return Card(
        sensor=row["sensor"],
        cluster=cluster,
        p=p,
        p_low=number(row["p_low"]),
        p_high=number(row["p_high"]),
        observations=int(row["observations"]),
        presses=int(row["presses"]),
        color=color_of(p),
        seen=f"{row['exemplar_log'][:MOST_SIGNS]}@{float(row['exemplar_time_s']):.1f}",
        drawing=drawing,
        photo=data_uri(scan.photo) if scan is not None else (uris[0] if uris else ""),
        members=tuple(uris[1:]),
    )
