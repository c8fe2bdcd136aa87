"""Sets of labelled image patches: procedural surfaces, or those the user names (figure 7)."""

from dataclasses import dataclass

import numpy as np

from mpap_cli.commands.inputs.labelled_patches import Draw, read_labelled_patches
from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.evaluation.clusterers.records import LabelledPoints
from mpap_cli.features.images.single_patches import embed_patches
from mpap_cli.outputs.patch_sheet import PatchLine, write_patch_sheet
from mpap_cli.simulation.texture_patches import N_A_CLASS, texture_patches

_SHORT_A_CLASS = 20
_SHOWN = 10


@dataclass(frozen=True, slots=True, eq=False)
class TextureSet:
    """Patches with classes, the names of these, and what draws patches by row."""

    seed: int
    points: LabelledPoints
    names: tuple[str, ...]
    draw: Draw

    def shuffled(self) -> LabelledPoints:
        """Return the points in the order of the seed."""
        return self.points.in_order(np.random.default_rng(self.seed).permutation(self.n))

    @property
    def n(self) -> int:
        """Number of patches."""
        return len(self.points.classes)


def texture_sets(bench: Bench, n: int | None = None) -> list[TextureSet]:
    """Return one set for each seed: other patches, or the user's in another order.

    Parameters
    ----------
    bench : Bench
        Seeds, and the patches of the user.
    n : int, optional
        Only the first so many.

    Raises
    ------
    LogError
        If the patches that the user names cannot be read.
    """
    seeds = bench.seeds[:n]
    if bench.request.textures is None:
        return [_made(bench, seed) for seed in seeds]
    read = read_labelled_patches(bench.request.textures, bench.settings("robust").image)
    bench.found.inputs.extend(read.inputs)
    bench.left_out(read.warn_of_losses())
    return [TextureSet(seed, read.points, read.class_names, read.draw) for seed in seeds]


def _made(bench: Bench, seed: int) -> TextureSet:
    """Make the patches of one seed."""
    made = texture_patches(seed, _SHORT_A_CLASS if bench.short else N_A_CLASS)
    features = embed_patches(made.patches, bench.settings("robust").image)
    points = LabelledPoints(features=features, classes=made.classes)
    return TextureSet(
        seed, points, made.class_names, lambda rows: {row: made.patches[row] for row in rows}
    )


def draw_classes(bench: Bench, textures: TextureSet) -> None:
    """Draw some patches of each class (figure 7)."""
    rng = np.random.default_rng(textures.seed)
    lines = []
    for number, name in enumerate(textures.names):
        members = np.flatnonzero(textures.points.classes == number)
        chosen = np.sort(rng.permutation(members)[:_SHOWN]).tolist()
        lines.append(PatchLine(name, list(textures.draw(chosen).values())))
    origin = "made by the tool" if bench.request.textures is None else "as given"
    caption = f"Image patches of the classes that are to be told apart, {origin}."
    write_patch_sheet(bench.picture("figure-7", caption), lines)
