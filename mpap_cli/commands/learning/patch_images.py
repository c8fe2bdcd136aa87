"""The exemplars of an appearance model as they were seen: patches of the logs' images."""

from collections.abc import Sequence
from pathlib import Path

from mpap_cli.commands.inputs.log_images import frames_at
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.features.images.patch_features import working_image
from mpap_cli.features.images.patches import cut_patches
from mpap_cli.outputs.canvas import Image
from mpap_cli.outputs.patch_pictures import PatchCluster, write_members, write_patch_exemplars
from mpap_cli.systems.appearance import AppearanceModel

_Key = tuple[str, int, int]
"""Base name of the log, stamp, number of the patch."""


def draw_patches(
    paths: Sequence[Path], model: AppearanceModel, selection: LogSelection
) -> list[PatchCluster]:
    """Draw the exemplars (Fig. 14) and members (Fig. 15) of the clusters of patches.

    Parameters
    ----------
    paths : sequence of Path
        Two PNG files to write: exemplars, members.
    model : AppearanceModel
        Clusters whose exemplars lie in logs of an older run are drawn without picture.
    selection : LogSelection
        The logs that have just been read.

    Returns
    -------
    list of PatchCluster
        What each cluster looks like, also of those that were not drawn.
    """
    exemplars, members = paths
    pictures = model.pictures()
    wanted = {key for picture in pictures for key in (picture.exemplar, *picture.members)}
    seen = _cut(model, selection, wanted)
    clusters = [
        PatchCluster(
            cluster=picture.cluster,
            p_obstacle=picture.p_obstacle,
            observations=picture.observations,
            presses=picture.presses,
            exemplar=seen.get(picture.exemplar),
            members=tuple(seen[key] for key in picture.members if key in seen),
        )
        for picture in pictures
    ]
    write_patch_exemplars(exemplars, clusters)
    write_members(members, clusters)
    return clusters


def _cut(model: AppearanceModel, selection: LogSelection, wanted: set[_Key]) -> dict[_Key, Image]:
    """Cut the wanted patches out of the images of the logs."""
    params = model.settings.image
    _, columns = params.rows_columns()
    found: dict[_Key, Image] = {}
    for log, stamp_ns, frame in frames_at(selection, {stamp_ns for _, stamp_ns, _ in wanted}):
        image = working_image(frame, params)
        if image is None:
            continue
        patches = cut_patches(image, params)
        for key in [key for key in wanted if key[:2] == (log, stamp_ns)]:
            found[key] = patches[divmod(key[2], columns)].copy()
    return found
