"""The commands as a user runs them: learn against a straightforward script, memory, evaluate."""

import sys
from functools import partial
from pathlib import Path

import cv2

from benchmarks.measuring.processes import (
    MPAP,
    children_in_turns,
    cpu_of,
    in_turns,
    run_child,
    simulated,
)
from benchmarks.measuring.table import Row
from benchmarks.speed import straightforward, straightforward_camera
from benchmarks.speed.scan_logs import repeated
from mpap_cli.commands.inputs.models import load_collision_model
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.learn import LearnRequest
from mpap_cli.commands.learn import learn as run_learn
from mpap_cli.commands.learning.summary import LearntScans
from mpap_cli.commands.settings import SettingsRequest

REPEATS = 3
SCRIPT = str(Path(straightforward.__file__))
LONG_H = 10
CAMERA_MIN = 5
# What is said, settings, and how the script decodes: images in full, and at half size.
_FULL = ("image-size=640x480", "image-decode=full")
_SIZES = (
    ("images in full", _FULL, cv2.IMREAD_COLOR),
    ("half size", (), cv2.IMREAD_REDUCED_COLOR_2),
)
EVALUATED_MIN = 10


def learn(folder: Path) -> list[Row]:
    """Learn from one hour of scans: whole processes, and the work after imports."""
    return [row for world in ("indoor", "outdoor") for row in _learn_rows(world, folder)]


def _learn_rows(world: str, folder: Path) -> list[Row]:
    """Compare one log, after making sure that both learn the same."""
    path = simulated(folder, world)
    out = folder / f"{world}-out"

    def by_mpap() -> LearntScans:
        selection = LogSelection(logs=(str(path),))
        scans = run_learn(selection, SettingsRequest(), LearnRequest(out=out)).scans
        if scans is None:
            msg = "no scans were learnt"
            raise RuntimeError(msg)
        return scans

    _compare(by_mpap(), straightforward.main(path), out)
    inside = in_turns([by_mpap, lambda: straightforward.main(path)], REPEATS)
    commands = [_learn_command(path, out), [sys.executable, SCRIPT, str(path)]]
    whole = [tuple(one.cpu_s for one in usages) for usages in children_in_turns(commands, REPEATS)]
    return [
        Row(
            work=f"learn 1 h {world}, {what}",
            mpap=mine,
            beside="straightforward script",
            peer=theirs,
            goal=">= 10x",
        )
        for what, (mine, theirs) in (("whole process", whole), ("after imports", inside))
    ]


def pipeline(folder: Path) -> list[Row]:
    """Learn from scans and images together, beside a script, and with two threads."""
    return _pipeline_rows(_camera_log(folder, CAMERA_MIN), CAMERA_MIN, REPEATS)


def hour(folder: Path) -> list[Row]:
    """Do the same with one hour: 18,000 images and 36,000 scans, once each."""
    path = _camera_log(folder, 60)
    for _, words, _ in _SIZES:
        learn_camera(_camera_log(folder, 1), words, 1)  # compiles the kernels
    return _pipeline_rows(path, 60, 1)


def _camera_log(folder: Path, minutes: int) -> Path:
    """Return a simulated log with a camera; it is written once."""
    path = folder / f"camera-{minutes}min.mcap"
    if not path.exists():
        options = ["--camera", "--bumper", "bool", "--duration", str(60 * minutes)]
        run_child([MPAP, "simulate", str(path), *options])
    return path


def _pipeline_rows(path: Path, minutes: int, repeats: int) -> list[Row]:
    """Learn from a log, beside the script, and with two threads beside one."""
    work = f"learn {minutes} min of camera (5 Hz) and scans (10 Hz)"
    return [*_beside_script(path, work, repeats), *_on_two_threads(path, work, repeats)]


def _beside_script(path: Path, work: str, repeats: int) -> list[Row]:
    """Compare both sizes of images with the script, which may read them in full or not."""
    mine, theirs = {}, {}
    for size, words, decode in _SIZES:
        if repeats > 1:
            learn_camera(path, words, 1)  # compiles the kernels
        mine[size] = tuple(cpu_of(partial(learn_camera, path, words, 1))[0] for _ in range(repeats))
        taken, learnt = cpu_of(partial(straightforward_camera.main, path, decode))
        theirs[size] = (taken,)
        print(f"script, {size}: {learnt}", file=sys.stderr)
    in_full, half = mine
    return [
        Row(
            work=f"{work}, {size}",
            mpap=mine[size],
            beside=f"straightforward script, {its}",
            peer=theirs[its],
            goal=">= 8x",
            stretch=stretch,
        )
        for size, its, stretch in (
            (in_full, in_full, ">= 12x"),
            (half, in_full, ">= 16x"),
            (half, half, ""),
        )
    ]


def _on_two_threads(path: Path, work: str, repeats: int) -> list[Row]:
    """Compare two threads with one: CPU time, and the time on the clock, which is the goal."""
    turns = [
        [cpu_of(partial(learn_camera, path, (), jobs))[0] for jobs in (2, 1)]
        for _ in range(repeats)
    ]
    two, one = (tuple(times) for times in zip(*turns, strict=True))
    clock_two, clock_one = (tuple(taken.clock for taken in times) for times in (two, one))
    return [
        Row(work=f"{work}, 2 threads", mpap=two, beside="1 thread", peer=one, goal="<="),
        Row(
            work=f"{work}, 2 threads, on the clock",
            mpap=clock_two,
            beside="1 thread, on the clock",
            peer=clock_one,
            goal="<= 0.6x",
        ),
    ]


def learn_camera(path: Path, words: tuple[str, ...], jobs: int) -> None:
    """Learn from the scans and images of a log."""
    selection = LogSelection(logs=(str(path),), sensor="auto")
    request = LearnRequest(out=path.with_suffix(""), jobs=jobs)
    run_learn(selection, SettingsRequest(pairs=words), request)


def _compare(scans: LearntScans, theirs: straightforward.Learnt, out: Path) -> None:
    """Say what both learnt.

    Raises
    ------
    RuntimeError
        If it is not the same number of scans, meta-points, cluster-points and labels.
    """
    counts = load_collision_model(out).meta_points.counts.sum(axis=0)
    found = straightforward.Learnt(
        n_scans=scans.n_scans,
        n_meta_points=scans.n_meta_points,
        n_cluster_points=scans.n_cluster_points,
        n_clusters=theirs.n_clusters,  # the jitter of scikit-learn is another one
        labels=tuple((int(free), int(pressed)) for free, pressed in counts),
    )
    print(f"mpap   {found}\nscript {theirs}", file=sys.stderr)
    if found != theirs:
        msg = "mpap and the straightforward script did not learn the same"
        raise RuntimeError(msg)


def _learn_command(path: Path, out: Path) -> list[str]:
    return [MPAP, "learn", str(path), "--out", str(out), "--quiet"]


def memory(folder: Path) -> list[Row]:
    """Compare the peak memory of learn on ten hours with that on one."""
    short_log = simulated(folder, "indoor")
    paths = [short_log, repeated(short_log, folder / "indoor-long.mcap", LONG_H)]
    commands = [_learn_command(path, folder / "memory-out") for path in paths]
    run_child(commands[0])  # compiles the kernels, which takes memory of its own
    short, long = (run_child(command) for command in commands)
    return [
        Row(
            work=f"learn, peak memory of a {LONG_H}-hour log",
            mpap=(long.peak_mb,),
            beside="the same of a 1-hour log",
            peer=(short.peak_mb,),
            unit="MB",
            goal="<= 1.1x",
        )
    ]


def evaluate(folder: Path) -> list[Row]:
    """Evaluate the whole table of the paper on two short logs, beside learning from them."""
    logs = [str(simulated(folder, world, EVALUATED_MIN)) for world in ("indoor", "outdoor")]
    out = ["--out", str(folder / "evaluate-out"), "--quiet"]
    run_child([MPAP, "learn", *logs, *out])
    learnt = run_child([MPAP, "learn", *logs, *out])
    scored = run_child([MPAP, "evaluate", "--feature", "all", "--bins", "6,12", *out])
    return [
        Row(
            work=f"evaluate --feature all --bins 6,12, 2 x {EVALUATED_MIN} min",
            mpap=(scored.cpu_s,),
            beside="learn from both",
            peer=(learnt.cpu_s,),
            goal="<=",
        )
    ]
