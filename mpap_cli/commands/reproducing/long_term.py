"""From environment A to B and back to A, the same day or months later (section 5.3.2)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mpap_cli.commands.inputs.log_images import frames_at
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.novelty import Novelty, NoveltyRequest, novelty
from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.camera_logs import Drive, Place, draw, repeats, settings_of
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.novelty import Boundary, NoveltyRow
from mpap_cli.features.images.image_decode import Image, decode_frame
from mpap_cli.logs.reader import open_log
from mpap_cli.logs.topics import TopicChoice, choose_roles, require_image
from mpap_cli.outputs.novelty_plot import plot_novelty
from mpap_cli.outputs.picture_sheets import write_rows

ITEMS = ("figure-16", "figure-17", "figure-18")
MINUTES = 6.0
_STEP_S = 10.0
_N_PICTURES = 6
_SWAPS = (("c", "b"), ("b", "c"))
_A, _B, _AGAIN, _LATER = "A", "B", "A again", "A'"
_CHAINS = {"figure-17": (_A, _B, _AGAIN), "figure-18": (_A, _B, _LATER)}


@dataclass(frozen=True, slots=True)
class Course:
    """Logs by what they are (A, B, A again, A'), and what was new along each chain of three."""

    logs: dict[str, str]
    met: dict[str, Novelty]


def run(bench: Bench) -> None:
    """Deliver figures 16 to 18.

    Notes
    -----
    Simulated environments are outdoors; the surfaces of A and B are exchanged from repeat to
    repeat, and A' is A in other light with other settings of the camera. Logs that the
    user names stand for both returns: whether the third is A again or A' is not known.
    """
    courses = [_play(bench, logs) for logs in _chains(bench)]
    bench.tell("went from A to B and back")
    for item, names in _CHAINS.items():
        met = [course.met[item] for course in courses if item in course.met]
        if met:
            _write_numbers(bench, item, names, met)
            _draw_course(bench, item, names, met[0])
    if bench.wants("figure-16"):
        _draw_images(bench, courses[0].logs)


def _chains(bench: Bench) -> list[dict[str, str]]:
    """Return the logs of each repeat by what they are."""
    if not bench.request.novelty:
        return [_simulated(bench, seed, repeat) for repeat, seed in enumerate(repeats(bench))]
    # a log named again is a return to its place
    paths = LogSelection(logs=bench.request.novelty, once=False).paths()
    if len(paths) != len(_CHAINS["figure-17"]):
        msg = f"--novelty: found {len(paths)} logs, expected three: A, B and A again"
        raise UsageError(msg)
    for path in dict.fromkeys(paths):
        bench.read(path)
    bench.finding("figure-18", "The logs that were named stand in Figure 17.")
    return [dict(zip(_CHAINS["figure-17"], map(str, paths), strict=True))]


def _simulated(bench: Bench, seed: int, repeat: int) -> dict[str, str]:
    """Simulate A, B, A again and A'."""
    here, there = (Place("Outdoor", "outdoor", textures) for textures in _SWAPS[repeat % 2])
    world = 2 * seed
    drives = {
        _A: Drive(place=here, world_seed=world, run=0, minutes=MINUTES),
        _B: Drive(place=there, world_seed=world + 1, run=1, minutes=MINUTES),
        _AGAIN: Drive(place=here, world_seed=world, run=2, minutes=MINUTES),
        _LATER: Drive(place=here, world_seed=world, run=3, minutes=MINUTES, light=_light(_LATER)),
    }
    needed = {name for item, names in _CHAINS.items() if bench.wants(item) for name in names}
    if bench.wants("figure-16"):
        needed |= {_A, _LATER, _B}
    return {
        name: str(draw(bench, drive, f"log-{number}"))
        for number, (name, drive) in enumerate(drives.items())
        if name in needed
    }


def _light(name: str) -> str:
    """Return the light in which an environment is seen."""
    return "evening" if name == _LATER else "day"


def _play(bench: Bench, logs: dict[str, str]) -> Course:
    """Meet the logs of each wanted chain one after the other."""
    met: dict[str, Novelty] = {}
    for item, names in _CHAINS.items():
        if bench.wants(item) and all(name in logs for name in names):
            met[item] = novelty(
                LogSelection(logs=tuple(logs[name] for name in names), sensor="image"),
                settings_of(bench, "robust"),
                NoveltyRequest(out=bench.scratch / "met", step_s=_STEP_S, jobs=1),
            )
            bench.left_out(met[item].exit_code)
    return Course(logs, met)


def _write_numbers(bench: Bench, item: str, names: tuple[str, ...], met: Sequence[Novelty]) -> None:
    """Write what each environment of a chain was like on entering it."""
    found: dict[str, list[Boundary]] = {
        name: [_boundary(one, index) for one in met] for index, name in enumerate(names)
    }
    unknown = {}
    for name, boundaries in found.items():
        first = [one.first_window_percent for one in boundaries]
        bench.number(item, name, "novel in the first minute (%)", first)
        shares = [one.percent_unknown_at_start for one in boundaries]
        unknown[name] = bench.number(item, name, "unknown at start (%)", shares).mean
    there, back = names[1:]
    if unknown[there] is None or unknown[back] is None:
        return
    bench.finding(
        item,
        f"Of {there} {unknown[there]:.0f} % was unknown to the model of {names[0]}, of {back} "
        f"{unknown[back]:.0f} %; novel in the first minute, to the model as it learns on, was "
        f"{_mean_first(found[there]):.0f} % in {there} and {_mean_first(found[back]):.0f} % in "
        f"{back}. {_spikes(_mean_first(found[there]), _mean_first(found[back]))}",
    )


def _spikes(there: float, back: float) -> str:
    """Compare the novelty of a new place with that of a return, in percent."""
    if there > 2 * back:
        return "As in the paper, the new place makes a spike and coming back does not."
    return "In the paper the new place makes a spike and coming back does not."


def _boundary(met: Novelty, index: int) -> Boundary:
    """Return what was met when a log began.

    Raises
    ------
    UsageError
        If none of its images could be used.
    """
    for boundary in met.boundaries:
        if boundary.log_index == index:
            return boundary
    msg = f"--novelty: no image of log {index + 1} could be used; name another one"
    raise UsageError(msg)


def _mean_first(boundaries: Sequence[Boundary]) -> float:
    return float(np.mean([one.first_window_percent for one in boundaries]))


def _draw_course(bench: Bench, item: str, names: tuple[str, ...], met: Novelty) -> None:
    """Draw figure 17 or 18."""
    rows: list[NoveltyRow] = [replace(row, log=names[row.log_index]) for row in met.rows]
    way = ", ".join(names)
    caption = (
        f"Novelty over windows of 60 s on the way through {way}; vertical lines are the changes "
        "of environment."
    )
    plot_novelty(bench.picture(item, caption), rows, met.boundaries)


def _draw_images(bench: Bench, logs: dict[str, str]) -> None:
    """Draw figure 16: images from A, A' (or A again) and B."""
    rows = []
    for name in (_A, _LATER if _LATER in logs else _AGAIN, _B):
        log = logs[name]
        below = Path(log).name if bench.request.novelty else _light(name)
        rows.append((name, below, _some_images(log)))
    caption = "Images from A, A' and B, evenly spread over each log."
    write_rows(bench.picture("figure-16", caption), rows)


def _some_images(log: str) -> list[Image]:
    """Return images evenly spread over a log."""
    selection = LogSelection(logs=(log,), sensor="image")
    images = [decode_frame(frame) for _, _, frame in frames_at(selection, _moments(Path(log)))]
    return [image for image in images if image is not None]


def _moments(log: Path) -> list[int]:
    """Return the stamps of images evenly spread over a log: the first after each moment."""
    with open_log(log) as reader:
        topic = require_image(choose_roles(reader, TopicChoice()), log.name)
        edges_ns = np.linspace(reader.start_ns, reader.end_ns, _N_PICTURES + 1).astype(np.int64)
        found = [
            next(iter(reader.messages([topic.name], middle_ns, reader.end_ns)), None)
            for middle_ns in ((edges_ns[1:] + edges_ns[:-1]) // 2).tolist()
        ]
    return list(dict.fromkeys(message.stamp_ns for message in found if message is not None))
