"""The map of a log with patches where they were seen (Fig. 12), gathered while it is replayed."""

from pathlib import Path

import numpy as np

from mpap_cli.commands.inputs.sources import Source
from mpap_cli.commands.predicting.image_decisions import Outlook
from mpap_cli.features.images.patch_features import working_image
from mpap_cli.features.images.patches import cut_patches
from mpap_cli.observations import Batch
from mpap_cli.outputs.canvas import Image
from mpap_cli.outputs.map_plot import MOST_PATCHES, MapPatch, plot_map
from mpap_cli.outputs.map_sketch import MapSketch
from mpap_cli.params import Settings

_Seen = tuple[int, Image, float]
"""Stamp, patch, probability."""


class MapDrawing:
    """Gathers the way, the scans, and for each cluster the first patch of either kind."""

    def __init__(self, source: Source, settings: Settings) -> None:
        start = source.start
        self._settings = settings
        self._sketch = MapSketch(settings.scan, start.forward_rad, start.range_max)
        self._seen: dict[tuple[int, bool], _Seen] = {}

    def add(self, batch: Batch, outlook: Outlook | None) -> None:
        """Take in what a batch holds; the outlook is None where it holds no image."""
        if batch.poses is not None:
            self._sketch.add_poses(batch.poses)
        for block in batch.scans:
            self._sketch.add_scans(block)
        if outlook is None or len(self._seen) >= MOST_PATCHES:
            return
        found = outlook.prediction
        kinds = found.cluster * 2 + outlook.obstacle
        known = ~found.unknown & (found.cluster >= 0)
        for kind in np.unique(kinds[known]).tolist():
            key = (kind // 2, kind % 2 == 1)
            if key not in self._seen:
                image, patch = np.argwhere(known & (kinds == kind))[0].tolist()
                self._keep(key, batch, outlook, image, patch)

    def _keep(
        self, key: tuple[int, bool], batch: Batch, outlook: Outlook, image: int, patch: int
    ) -> None:
        """Cut a patch out of its image."""
        params = self._settings.image
        pixels = working_image(batch.frames[int(outlook.block.kept[image])], params)
        if pixels is not None:
            _, columns = params.rows_columns()
            picture = cut_patches(pixels, params)[divmod(patch, columns)].copy()
            p = float(outlook.prediction.p_obstacle[image, patch])
            self._seen[key] = (int(outlook.block.stamps_ns[image]), picture, p)

    def write(self, path: Path, title: str) -> None:
        """Draw the map; nothing is written where there is no odometry or no scan."""
        if not (self._sketch.way.size and self._sketch.returns.size):
            return
        seen = list(self._seen.values())[:MOST_PATCHES]
        places = self._sketch.places(np.array([stamp_ns for stamp_ns, _, _ in seen], np.int64))
        patches = [
            MapPatch(x_m=x, y_m=y, picture=picture, p_obstacle=p)
            for (x, y, _), (_, picture, p) in zip(places.tolist(), seen, strict=True)
            if np.isfinite(x)
        ]
        threshold = self._settings.obstacle.patch_threshold
        plot_map(path, self._sketch, patches, threshold, title)
