"""The exemplar of every cluster as it was seen: its scan, and the image of that moment."""

import logging
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mpap_cli.commands.inputs.log_images import frames_at
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.features.images.image_decode import Image, decode_frame
from mpap_cli.observations import ObservedLog, ScanBlock
from mpap_cli.outputs.recording import blocks_around, read_recording
from mpap_cli.outputs.scan_pictures import ExemplarPicture, write_exemplars
from mpap_cli.outputs.text_table import count
from mpap_cli.systems.cluster_rows import ClusterRow

LOGGER = logging.getLogger(__name__)


def draw_exemplars(
    path: Path,
    clusters: Sequence[ClusterRow],
    recording: Path,
    selection: LogSelection,
) -> list[ExemplarPicture]:
    """Draw exemplars.png (Fig. 11).

    Parameters
    ----------
    path : Path
        PNG to write.
    clusters : sequence of ClusterRow
        Those whose exemplars lie in logs of an older run are left out.
    recording : Path
        Scans of the logs that have just been read.
    selection : LogSelection
        The same logs, for the images.

    Returns
    -------
    list of ExemplarPicture
        What each cluster's exemplar looks like, also of those that were not drawn.
    """
    rows = {(row.exemplar_log, row.exemplar_stamp_ns): row for row in clusters}
    images = _images(selection, {key[1] for key in rows}) if rows else {}
    observed = read_recording(recording)
    stamps_ns = np.array([stamp_ns for _, stamp_ns in rows], dtype=np.int64)
    pictures = [
        _picture(row, observed[log], block, index, images)
        for log, block in blocks_around(recording, stamps_ns)
        for index, row in _exemplars_in(observed[log], block, rows)
    ]
    write_exemplars(path, pictures)
    return pictures


def _exemplars_in(
    log: ObservedLog, block: ScanBlock, rows: dict[tuple[str, int], ClusterRow]
) -> list[tuple[int, ClusterRow]]:
    """Return the exemplars of a block with their place in it."""
    wanted = np.array([stamp_ns for name, stamp_ns in rows if name == log.name], dtype=np.int64)
    places = np.flatnonzero(np.isin(block.stamps_ns, wanted))
    return [(int(place), rows[log.name, int(block.stamps_ns[place])]) for place in places]


def _picture(
    row: ClusterRow, log: ObservedLog, block: ScanBlock, index: int, images: dict[int, Image]
) -> ExemplarPicture:
    """Put together what is drawn of one cluster."""
    return ExemplarPicture(
        cluster=row.cluster,
        p_collision=row.p_collision,
        p_low=row.p_low,
        p_high=row.p_high,
        observations=row.observations,
        first_seen_s=row.first_seen_s,
        log=row.exemplar_log,
        time_s=row.exemplar_time_s,
        ranges=block.ranges[index].copy(),
        geometry=block.geometry,
        forward_rad=log.forward_rad,
        range_max=log.range_max,
        image=images.get(row.exemplar_stamp_ns),
    )


def _images(selection: LogSelection, stamps_ns: set[int]) -> dict[int, Image]:
    """Return the image nearest to each stamp, within a fifth of a second."""
    images: dict[int, Image] = {}
    undecoded: Counter[str] = Counter()
    for log, stamp_ns, frame in frames_at(selection, stamps_ns):
        image = decode_frame(frame)
        if image is None:
            undecoded[log] += 1
        else:
            images[stamp_ns] = image
    for log, n_bad in undecoded.items():
        LOGGER.warning("%s: %s could not be decoded", log, count(n_bad, "image"))
    return images
