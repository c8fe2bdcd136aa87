"""What ``reproduce`` is asked for."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True, kw_only=True)
class ReproduceRequest:
    """Where results go, whose data are used, and which parts are made.

    Parameters
    ----------
    out : Path
        Results folder.
    textures : Path, optional
        Labelled patches: a folder with a folder a class, or an npz (default: procedural).
    indoor, outdoor : tuple of str
        Laser logs, paths or globs (default: simulated ones, a world for each seed).
    novelty : tuple of str
        Three camera logs A, B and A again (default: simulated ones).
    seeds : int
        Repeats of what is simulated or shuffled.
    only : tuple of str
        Keys of ``ITEMS``; empty: everything.
    short : bool
        Everything small, to see whether it runs: the numbers mean nothing then.
    jobs : int
        Experiments that run side by side, each in a process of its own.
    seed : int
        First of the seeds.
    """

    out: Path
    textures: Path | None = None
    indoor: tuple[str, ...] = ()
    outdoor: tuple[str, ...] = ()
    novelty: tuple[str, ...] = ()
    seeds: int = 10
    only: tuple[str, ...] = ()
    short: bool = False
    jobs: int = 2
    seed: int = 0
