"""Recorded images of one log become BGR pixels, one after the other."""

from collections.abc import Iterator, Sequence

from mpap_cli.features.images.image_decode import COMPRESSED, Decoded, as_recorded, decode_scaled
from mpap_cli.features.images.pixel_formats import RAW_ENCODINGS
from mpap_cli.features.images.video_decode import VideoDecoder
from mpap_cli.observations import VIDEO_ENCODINGS, Frame

BROKEN = "cut off or not decodable"


class FrameDecoder:
    """Decodes images in their order, which for video costs least.

    Parameters
    ----------
    smallest : tuple of int, optional
        Width and height that a JPEG keeps at least, as in
        :func:`~mpap_cli.features.images.image_decode.decode_scaled`.
    """

    def __init__(self, smallest: tuple[int, int] | None = None) -> None:
        self._smallest = smallest
        self._video = VideoDecoder()

    def decode(self, frames: Sequence[Frame]) -> Iterator[tuple[int, Decoded | str]]:
        """Decode images of one log.

        Parameters
        ----------
        frames : sequence of Frame
            In the order in which they were recorded; some may be left out.

        Yields
        ------
        tuple of int and (Decoded or str)
            Which of the frames, each once, and its image, or why there is none. Only
            pictures of video may come in another order than the frames.

        Raises
        ------
        UsageError
            If there is video and PyAV is missing.

        Examples
        --------
        >>> frames = [Frame(0, "mono8", 1, 1, 1, bytes([7])), Frame(0, "32FC1", 1, 1, 4, bytes(4))]
        >>> gray, depth = FrameDecoder().decode(frames)
        >>> gray[1].image.tolist(), depth
        ([[[7, 7, 7]]], (1, 'encoding 32FC1'))
        """
        video: list[int] = []
        for position, frame in enumerate(frames):
            if frame.encoding in VIDEO_ENCODINGS:
                video.append(position)
            else:
                yield position, self.still(frame)
        if not video:  # PyAV, an extra, may be missing
            return
        for number, found in self._video.decode([frames[position] for position in video]):
            yield video[number], found if isinstance(found, str) else as_recorded(found)

    def still(self, frame: Frame) -> Decoded | str:
        """Decode an image that is no video, in any thread; or say why there is none."""
        if frame.encoding != COMPRESSED and frame.encoding not in RAW_ENCODINGS:
            return f"encoding {frame.encoding}"
        decoded = decode_scaled(frame, self._smallest)
        return BROKEN if decoded is None else decoded
