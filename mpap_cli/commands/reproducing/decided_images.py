"""A few images of each decision, with what was predicted of their patches (Fig. 6)."""

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mpap_cli.commands.inputs.log_images import frames_at
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.evaluation.patch_files import read_seen_patches
from mpap_cli.features.images.image_decode import decode_frame
from mpap_cli.outputs.annotated import annotate, write_annotated_sheet
from mpap_cli.outputs.canvas import Image
from mpap_cli.params import ObstacleParams
from mpap_cli.systems.decision import ACTIONS


@dataclass(frozen=True, slots=True)
class DecidedLog:
    """One log, and the folder in which ``predict`` wrote what it said of it."""

    selection: LogSelection
    folder: Path


@dataclass(frozen=True, slots=True)
class Decided:
    """The decision at one image."""

    action: str
    stamp_ns: int
    time_s: float
    obstacle_patches: int


def draw_decided(path: Path, logs: Sequence[DecidedLog]) -> None:
    """Draw for each log one image of each action that was decided (Fig. 6).

    Parameters
    ----------
    path : Path
        PNG to write.
    logs : sequence of DecidedLog
        One row each; the patches are those of ``patches.csv``.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    write_annotated_sheet(path, [image for log in logs for image in _annotated(log)])


def choose_decided(decisions: Sequence[Decided], n_patches: int) -> list[Decided]:
    """Choose for each action the image with most nearly as many obstacles as free patches.

    Parameters
    ----------
    decisions : sequence of Decided
        In the order of time; of equals the first is chosen.
    n_patches : int
        Patches of an image.

    Returns
    -------
    list of Decided
        At most one for each action, in the order of ``ACTIONS``.
    """
    chosen = []
    for action in ACTIONS:
        mine = [one for one in decisions if one.action == action]
        if mine:
            chosen.append(min(mine, key=lambda one: abs(2 * one.obstacle_patches - n_patches)))
    return chosen


def _annotated(log: DecidedLog) -> Iterator[tuple[Image, str]]:
    """Yield the images of a log with their captions."""
    seen = read_seen_patches(log.folder / "patches.csv", 0)
    places = seen.places
    if not places.rows.size:
        return
    shape = int(places.rows.max()) + 1, int(places.columns.max()) + 1
    chosen = choose_decided(_read(log.folder / "decisions.csv"), shape[0] * shape[1])
    images = {
        stamp_ns: frame
        for _, stamp_ns, frame in frames_at(log.selection, [one.stamp_ns for one in chosen])
    }
    for one in chosen:
        image = decode_frame(images[one.stamp_ns]) if one.stamp_ns in images else None
        if image is None:
            continue
        mine = places.stamps_ns == one.stamp_ns
        p, unknown = seen.p_obstacle[mine].reshape(shape), seen.unknown[mine].reshape(shape)
        threshold = ObstacleParams().patch_threshold
        name = Path(log.selection.logs[0]).stem
        yield annotate(image, p, unknown, one.action, threshold), f"{name}, {one.time_s:.1f} s"


def _read(path: Path) -> list[Decided]:
    """Read decisions.csv."""
    with path.open(encoding="utf-8", newline="") as file:
        return [
            Decided(
                action=row["action"],
                stamp_ns=int(row["stamp_ns"]),
                time_s=float(row["time_s"]),
                obstacle_patches=int(row["obstacle_patches"]),
            )
            for row in csv.DictReader(file)
        ]
