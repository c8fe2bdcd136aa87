"""The commands as a user runs them: learn against a straightforward script, memory, evaluate."""

import sys
from pathlib import Path

from benchmarks import straightforward
from benchmarks.measuring import MPAP, children_in_turns, in_turns, run_child, simulated
from benchmarks.table import Row
from mpap_cli.commands.inputs.models import load_collision_model
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.learn import LearnRequest, LearntScans
from mpap_cli.commands.learn import learn as run_learn
from mpap_cli.commands.settings import SettingsRequest

REPEATS = 3
SCRIPT = str(Path(straightforward.__file__))
LONG_H = 10
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
    paths = [simulated(folder, "indoor"), simulated(folder, "indoor", 60 * LONG_H)]
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
