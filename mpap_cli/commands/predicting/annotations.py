"""Images with what was predicted of them (Fig. 6): a sheet of some, a log of all."""

from pathlib import Path

import cv2
import numpy as np

from mpap_cli.commands.inputs.sources import Source
from mpap_cli.commands.predicting.image_decisions import Outlook
from mpap_cli.commands.predicting.prediction_log import IMAGE_TOPIC
from mpap_cli.features.images.frame_decoder import FrameDecoder
from mpap_cli.logs.writing.event_log import EventLogWriter
from mpap_cli.observations import NS_PER_S, Batch, BoolArray, IntArray
from mpap_cli.outputs.annotated import MOST_ON_SHEET, annotate, write_annotated_sheet
from mpap_cli.outputs.canvas import Image
from mpap_cli.params import Settings
from mpap_cli.systems.decision import ACTIONS

_BEFORE_NS = NS_PER_S // 2
_JPEG_QUALITY = 80


class Annotator:
    """Draws predictions on images.

    On the sheet stand images that are evenly spread over each log, and those half a second
    before a press; of many, every other one is dropped, so that memory stays bounded.
    """

    def __init__(self, settings: Settings) -> None:
        self._shape = settings.image.rows_columns()
        self._threshold = settings.obstacle.patch_threshold
        self._decoder = FrameDecoder()
        self._images: list[tuple[Image, str]] = []
        self._name = ""
        self._start_ns = self._due_ns = self._step_ns = 0

    def begin_log(self, source: Source) -> None:
        """Start with the next log."""
        self._decoder = FrameDecoder()
        self._name, self._start_ns = source.name, source.start.start_ns
        self._due_ns = source.replay.start_ns
        length_ns = source.replay.end_ns - source.replay.start_ns
        self._step_ns = max(length_ns // (MOST_ON_SHEET // 2), 1)

    def add(self, batch: Batch, outlook: Outlook, log: EventLogWriter | None) -> None:
        """Annotate what is wanted of a batch: for the sheet, and all of it for the log."""
        stamps_ns = outlook.block.stamps_ns
        shown = self._for_sheet(batch, stamps_ns)
        wanted = np.flatnonzero(shown | (log is not None)).tolist()
        frames = [batch.frames[int(outlook.block.kept[image])] for image in wanted]
        sheet: dict[int, Image] = {}
        for number, found in self._decoder.decode(frames):
            if isinstance(found, str):
                continue  # leading pictures of a video, which gave features in its course only
            image = wanted[number]
            drawn = self._annotated(found.image, outlook, image)
            if shown[image]:
                sheet[image] = drawn
            if log is not None:
                log.image(IMAGE_TOPIC, int(stamps_ns[image]), _jpeg(drawn))
        for image, drawn in sorted(sheet.items()):
            seconds = (int(stamps_ns[image]) - self._start_ns) / NS_PER_S
            self._images.append((drawn, f"{self._name}@{seconds:.1f}"))
        if len(self._images) > 2 * MOST_ON_SHEET:
            self._images = self._images[::2]

    def write(self, path: Path) -> None:
        """Write the sheet."""
        write_annotated_sheet(path, self._images)

    def _for_sheet(self, batch: Batch, stamps_ns: IntArray) -> BoolArray:
        """Tell which images of a batch (n,) go on the sheet."""
        shown = np.zeros(stamps_ns.size, dtype=np.bool_)
        for image, stamp_ns in enumerate(stamps_ns.tolist()):
            if stamp_ns >= self._due_ns:
                shown[image] = True
                self._due_ns += self._step_ns * (1 + (stamp_ns - self._due_ns) // self._step_ns)
        for bump in batch.bumps:
            before = int(np.searchsorted(stamps_ns, bump.stamp_ns - _BEFORE_NS, side="right")) - 1
            if bump.pressed and before >= 0:
                shown[before] = True
        return shown

    def _annotated(self, pixels: Image, outlook: Outlook, image: int) -> Image:
        """Draw one image."""
        return annotate(
            pixels,
            outlook.prediction.p_obstacle[image].reshape(self._shape),
            outlook.prediction.unknown[image].reshape(self._shape),
            ACTIONS[int(outlook.actions[image])],
            self._threshold,
        )


def _jpeg(image: Image) -> bytes:
    """Encode an image for the log."""
    _, encoded = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
    return encoded.tobytes()
