"""The exemplar of every cluster as it was seen: its scan, and the image of that moment."""

import logging
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mpap_cli.commands.selection import LogSelection
from mpap_cli.errors import LogError
from mpap_cli.features.images.image_decode import Image, decode_frame
from mpap_cli.logs.frames import read_frame
from mpap_cli.logs.reader import LogReader, RawMessage, Topic, expand_paths, open_log
from mpap_cli.logs.topics import choose_roles
from mpap_cli.observations import NS_PER_S, ObservedLog, ScanBlock
from mpap_cli.outputs.evaluate_text import count
from mpap_cli.outputs.recording import blocks_around, read_recording
from mpap_cli.outputs.scan_pictures import ExemplarPicture, write_exemplars
from mpap_cli.systems.cluster_rows import ClusterRow

LOGGER = logging.getLogger(__name__)
SAME_MOMENT_NS = NS_PER_S // 5


def draw_exemplars(
    path: Path,
    clusters: Sequence[ClusterRow],
    recording: Path,
    selection: LogSelection,
) -> None:
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
    for path in {path.resolve(): path for path in expand_paths(selection.logs)}.values():
        try:
            reader = open_log(path, msgs=selection.msgs)
        except LogError:
            continue  # told when its scans were read
        with reader:
            topic = choose_roles(reader, selection.topic_choice).image
            if topic is None:
                continue
            near = {stamp_ns: _message_at(reader, topic, stamp_ns) for stamp_ns in stamps_ns}
            seen = {at_ns: _decode(reader, message) for at_ns, message in near.items() if message}
        images |= {stamp_ns: image for stamp_ns, image in seen.items() if image is not None}
        n_bad = sum(image is None for image in seen.values())
        if n_bad:
            LOGGER.warning("%s: %s could not be decoded", path.name, count(n_bad, "image"))
    return images


def _message_at(reader: LogReader, topic: Topic, stamp_ns: int) -> RawMessage | None:
    """Return the image message nearest to a stamp, if one is near."""
    window = (stamp_ns - SAME_MOMENT_NS, stamp_ns + SAME_MOMENT_NS)
    messages = [
        message
        for message in reader.messages([topic.name], *window)
        if message.topic.msgtype == topic.msgtype
    ]
    return min(messages, key=lambda message: abs(message.stamp_ns - stamp_ns), default=None)


def _decode(reader: LogReader, message: RawMessage) -> Image | None:
    """Return the image of a message, None if it is broken."""
    try:
        return decode_frame(read_frame(reader, message))
    except LogError:
        return None
