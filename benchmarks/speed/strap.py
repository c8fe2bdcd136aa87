"""Patches into clusters on two scales (Algorithm 2), against the least a search costs."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.measuring.processes import cpu_of, in_turns
from benchmarks.measuring.table import Row
from benchmarks.speed.streams import F32, patch_stream
from mpap_cli.clustering.affinity_propagation import affinity_propagation
from mpap_cli.clustering.preference import resolve_preference
from mpap_cli.clustering.two_scale import TwoScale
from mpap_cli.distance import similarities
from mpap_cli.observations import IntArray
from mpap_cli.params import AffinityParams, StrapParams

REPEATS = 3
PATCHES = 36
_PER_HOUR = 5 * 3600 * PATCHES
_BLOCK = 250 * PATCHES
_AFFINITY = AffinityParams()
_STRAP = StrapParams(eps=0.18)


def strap(_folder: Path) -> list[Row]:
    """Insert patches near 1,000 exemplars, rebuild there, and stay in one world for two hours."""
    many = _filled(n_kinds=1000)
    return [_search(many), _rebuild(many), *_two_hours()]


def _filled(n_kinds: int) -> tuple[TwoScale, F32]:
    """Return a model that knows so many kinds of patches, and others of the same kinds."""
    points = patch_stream(n_kinds, 60 * n_kinds, spread=0.08)
    model = TwoScale(replace(_STRAP, reservoir=2000), _AFFINITY, points.shape[1])
    _add(model, points, np.arange(len(points)))
    model.rebuild()
    return model, patch_stream(n_kinds, 20_000, spread=0.08, seed=1)


def _add(model: TwoScale, points: F32, places: IntArray) -> None:
    """Add patches, each at its own stamp."""
    model.add_observations(points, places, places % PATCHES, log_index=0)


def _search(filled: tuple[TwoScale, F32]) -> Row:
    """Compare insertion with the matrix product of the same patches and exemplars."""
    model, points = filled
    exemplars, out = model.exemplars, np.empty((256, model.n_clusters), np.float32)

    def multiply() -> None:
        for start in range(0, len(points), len(out)):
            block = points[start : start + len(out)]
            np.matmul(block, exemplars.T, out=out[: len(block)])

    insert, product = (
        tuple(1e6 * seconds / len(points) for seconds in times)
        for times in in_turns(
            [lambda: _add(model, points, np.arange(len(points))), multiply], REPEATS
        )
    )
    work = f"insert a patch, 109-D, {len(exemplars)} exemplars"
    beside = "float32 gemm with the exemplars"
    return Row(work=work, mpap=insert, beside=beside, peer=product, unit="us", goal="<= 3x")


def _rebuild(filled: tuple[TwoScale, F32]) -> Row:
    """Compare a rebuild after 500 patches of a new place with the same problem over all items.

    Weights are those of a rebuild: without them this one does not converge at first.
    """
    model, _ = filled
    new = patch_stream(25, 500, spread=0.08, seed=2)
    known = model.state()
    items = np.concatenate([known["clusters.exemplars"], new])
    heavy = np.minimum(known["clusters.weight"], model.strap.weight_cap)
    weights = np.concatenate([heavy, np.ones(len(new))])[:, None]

    def rebuild() -> float:
        copy = TwoScale.from_state(model.strap, _AFFINITY, known)
        _add(copy, new, np.arange(500))
        return cpu_of(copy.rebuild)[0]

    def over_all() -> None:
        s = similarities(items)
        affinity_propagation(weights * s, resolve_preference(s, "median"), _AFFINITY)

    rebuild()
    mine, peer = zip(*[(rebuild(), cpu_of(over_all)[0]) for _ in range(REPEATS)], strict=True)
    work = f"rebuild, {model.n_clusters} exemplars, 500 outliers"
    return Row(work=work, mpap=mine, beside="weighted AP over all items", peer=peer, goal=">=")


def _two_hours() -> list[Row]:
    """Stay in a world of 40 blobs whose noise puts a sixth of the patches outside."""
    noisy = replace(_STRAP, known_share=0.3, noise_share=0.35)
    model = TwoScale(noisy, _AFFINITY, 109)
    sizes, times = [], []
    for hour in range(2):
        seconds = 0.0
        for block in range(_PER_HOUR // _BLOCK):
            first = hour * _PER_HOUR + block * _BLOCK
            points = patch_stream(40, _BLOCK, spread=0.13, seed=first)
            seconds += cpu_of(lambda: _add(model, points, first + np.arange(_BLOCK)))[0]  # noqa: B023  # called at once
        sizes.append(model.n_clusters)
        times.append(seconds)
    return [
        Row(
            work="exemplars after two hours among blobs",
            mpap=(float(sizes[1]),),
            beside="after one hour",
            peer=(float(sizes[0]),),
            unit="",
            goal="<= 1x",
        ),
        Row(
            work="second hour of 648,000 patches",
            mpap=(times[1],),
            beside="first hour",
            peer=(times[0],),
            goal="<= 1.15x",
        ),
    ]
