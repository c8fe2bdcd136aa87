"""The map of a log with patches where they were seen (Fig. 12), gathered while it is replayed."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpap_cli.commands.inputs.sources import Source
from mpap_cli.commands.predicting.image_decisions import Outlook
from mpap_cli.features.images.patch_features import working_image
from mpap_cli.features.images.patches import cut_patches
from mpap_cli.observations import Batch, Float64Array
from mpap_cli.outputs.canvas import Image
from mpap_cli.outputs.map_plot import MOST_PATCHES, MapPatch, plot_map
from mpap_cli.outputs.map_sketch import MapSketch
from mpap_cli.params import Settings

_MOST_PLACES = 12
_APART_M = 0.8


@dataclass(frozen=True, slots=True, eq=False)
class _Sighting:
    """A patch, its probability, and where the robot saw it from (2,), in metres."""

    picture: Image
    p: float
    place: Float64Array


class MapDrawing:
    """Gathers the way, the scans, and patches of either kind of each cluster.

    Of a kind the first patch is kept, and later ones seen from elsewhere; what is drawn of
    them lies as far apart as possible.
    """

    def __init__(self, source: Source, settings: Settings) -> None:
        start = source.start
        self._settings = settings
        self._sketch = MapSketch(settings.scan, start.forward_rad, start.range_max)
        self._seen: dict[tuple[int, bool], list[_Sighting]] = {}

    def add(self, batch: Batch, outlook: Outlook | None) -> None:
        """Take in what a batch holds; the outlook is None where it holds no image."""
        if batch.poses is not None:
            self._sketch.add_poses(batch.poses)
        for block in batch.scans:
            self._sketch.add_scans(block)
        if outlook is None:
            return
        found = outlook.prediction
        places = self._sketch.places(outlook.block.stamps_ns)[:, :2]
        kinds = found.cluster * 2 + outlook.obstacle
        known = ~found.unknown & (found.cluster >= 0) & np.isfinite(places[:, :1])
        for kind in np.unique(kinds[known]).tolist():
            # the patch that is most like its cluster
            distance = np.where(known & (kinds == kind), found.distance, np.inf)
            image, patch = divmod(int(distance.argmin()), distance.shape[1])
            key = (kind // 2, kind % 2 == 1)
            if self._is_elsewhere(key, places[image]):
                self._keep(key, batch, outlook, (image, patch), places[image])

    def _is_elsewhere(self, key: tuple[int, bool], place: Float64Array) -> bool:
        """Tell whether a kind is new, or was seen from afar only, and there is room for it."""
        if key not in self._seen:
            return len(self._seen) < MOST_PATCHES
        kept = self._seen[key]
        return len(kept) < _MOST_PLACES and _gap(place, kept) >= _APART_M

    def _keep(
        self,
        key: tuple[int, bool],
        batch: Batch,
        outlook: Outlook,
        at: tuple[int, int],
        place: Float64Array,
    ) -> None:
        """Cut a patch out of its image."""
        image, patch = at
        params = self._settings.image
        pixels = working_image(batch.frames[int(outlook.block.kept[image])], params)
        if pixels is not None:
            _, columns = params.rows_columns()
            picture = cut_patches(pixels, params)[divmod(patch, columns)].copy()
            p = float(outlook.prediction.p_obstacle[image, patch])
            self._seen.setdefault(key, []).append(_Sighting(picture, p, place))

    def write(self, path: Path, title: str) -> None:
        """Draw the map; nothing is written where there is no odometry or no scan."""
        if not (self._sketch.way.size and self._sketch.returns.size):
            return
        patches = [
            MapPatch(x_m=x, y_m=y, picture=one.picture, p_obstacle=one.p)
            for one in _spread(list(self._seen.values()))
            for x, y in [one.place.tolist()]
        ]
        threshold = self._settings.obstacle.patch_threshold
        plot_map(path, self._sketch, patches, threshold, title)


def _gap(place: Float64Array, others: Sequence[_Sighting]) -> float:
    """Return the metres from a place to the nearest of other sightings, inf without any."""
    return min((float(np.hypot(*(place - one.place))) for one in others), default=np.inf)


def _spread(kinds: Sequence[Sequence[_Sighting]]) -> list[_Sighting]:
    """Choose one patch of each kind, then more, each as far as possible from those before."""
    chosen: list[_Sighting] = []
    for kept in kinds:
        chosen.append(max(kept, key=lambda one: _gap(one.place, chosen)))
    rest = [one for kept in kinds for one in kept if one not in chosen]
    while rest and len(chosen) < MOST_PATCHES:
        chosen.append(max(rest, key=lambda one: _gap(one.place, chosen)))
        rest.remove(chosen[-1])
    return chosen
