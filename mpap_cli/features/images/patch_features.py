"""Camera images become embedded patches (section 4.2.2)."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import astuple
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mpap_cli.features.images import _kernels
from mpap_cli.features.images.frame_decoder import FrameDecoder
from mpap_cli.features.images.image_decode import Decoded, Image, decode_frame
from mpap_cli.features.images.lbp import uniform_codes
from mpap_cli.features.images.patches import lay_out_patches
from mpap_cli.features.images.pixels._kernels import describe_pixels
from mpap_cli.observations import VIDEO_ENCODINGS, Float32Array, Frame, PatchBlock
from mpap_cli.params import ImageParams

BLACK = "black"
SIZE_CHANGES = "size changes"
ENCODING_CHANGES = "encoding changes"
# A covered lens leaves no pixel above the first bin of the value.
_BRIGHT = slice(_kernels.COLOR_BINS - _kernels.CHANNEL_BINS + 1, _kernels.COLOR_BINS)

_Described = tuple[NDArray[np.uint16], NDArray[np.uint8]]


class _Seen(NamedTuple):
    """What is known of an image that could be decoded: the size it was recorded with."""

    size: tuple[int, int]
    is_black: bool


class PatchEmbedder:
    """Turn camera images into blocks of embedded patches.

    Parameters
    ----------
    params : ImageParams
        Grid, working image, operator of the texture, weight of the color.

    Attributes
    ----------
    n_dims : int
        Number of dimensions of a patch: 109.
    rows, columns, n_patches : int
        Those of the grid.
    skipped : Counter
        How many images were left out, by reason: ``cut off or not decodable``, ``black``
        (no pixel reaches 16 of 255), ``encoding NAME`` (not read), and what
        :mod:`~mpap_cli.features.images.video_decode` says of video.
    changes : Counter
        ``size changes``, ``encoding changes``: how often an image had another size or
        encoding than the one before; such images are used.

    Notes
    -----
    A patch is described by two histograms. Color: the marginals of hue, saturation and
    value, 16 bins each, of OpenCV's 8-bit HSV, each of mass 1/3. Texture: the uniform local
    binary patterns of the gray image, 59 bins; pixels at the border of the working image
    have no pattern. u = [sqrt(w) u_color, sqrt(1 - w) u_texture] has length 1, so d^2 of
    equation 7 is w d_color^2 + (1 - w) d_texture^2. Each part ends with the coordinate that
    :func:`mpap_cli.distance.embed` adds, 0 here since no patch is empty.
    """

    def __init__(self, params: ImageParams) -> None:
        self.params = params
        grid = lay_out_patches(params)
        self.rows, self.columns = grid.rows, grid.columns
        self.n_patches = grid.rows * grid.columns
        self.n_dims = _kernels.COLOR_BINS + 1 + _kernels.TEXTURE_BINS + 1
        self._grid = np.array(astuple(grid), np.int64)
        self._uniform = uniform_codes()
        self._size, self._smallest = params.width_height(), _smallest(params)
        self.for_log()

    def for_log(self) -> None:
        """Begin another log: count anew, and expect no size or encoding."""
        self.skipped: Counter[str] = Counter()
        self.changes: Counter[str] = Counter()
        self._decoder = FrameDecoder(self._smallest)
        self._last: tuple[str, tuple[int, int]] | None = None

    def transform(self, frames: Sequence[Frame], jobs: int = 1) -> PatchBlock:
        """Decode images and describe their patches.

        Parameters
        ----------
        frames : sequence of Frame
            Consecutive images of one log.
        jobs : int
            Threads among which the images are shared out, but for video, whose pictures
            depend on one another. The features do not depend on it.

        Returns
        -------
        PatchBlock
            Of the images that can be used; the others are counted in ``skipped``.
        """
        features = np.empty((len(frames), self.n_patches, self.n_dims), np.float32)
        kept: list[int] = []
        for position, seen in self._look_at(frames, features, jobs):
            if isinstance(seen, str):
                self.skipped[seen] += 1
                continue
            self._compare(frames[position].encoding, seen.size)
            if seen.is_black:
                self.skipped[BLACK] += 1
            else:
                kept.append(position)
        kept.sort()
        return PatchBlock(
            stamps_ns=np.array([frames[position].stamp_ns for position in kept], np.int64),
            features=features if len(kept) == len(frames) else features[kept],
            kept=np.array(kept, np.int64),
        )

    def _look_at(
        self, frames: Sequence[Frame], features: Float32Array, jobs: int
    ) -> Iterator[tuple[int, _Seen | str]]:
        """Write the features of images; yield what was seen of each, or why nothing."""
        stills = [n for n, frame in enumerate(frames) if frame.encoding not in VIDEO_ENCODINGS]
        parts = [part.tolist() for part in np.array_split(stills, jobs) if part.size]

        def look(part: list[int]) -> list[_Seen | str]:
            return list(
                map(self._viewer(features), part, (self._decoder.still(frames[n]) for n in part))
            )

        if len(parts) > 1:
            with ThreadPoolExecutor(len(parts)) as pool:
                seen = chain.from_iterable(list(pool.map(look, parts)))
        else:
            seen = chain.from_iterable(map(look, parts))
        yield from zip(stills, seen, strict=True)
        if len(stills) < len(frames):
            video = [n for n, frame in enumerate(frames) if frame.encoding in VIDEO_ENCODINGS]
            view = self._viewer(features)
            for position, found in self._decoder.decode([frames[n] for n in video]):
                yield video[position], view(video[position], found)

    def _viewer(self, features: Float32Array) -> Callable[[int, Decoded | str], _Seen | str]:
        """Return what writes the features of one image after the other, for one thread."""
        described = np.empty(self._size[::-1], np.uint16), np.empty(self._size[::-1], np.uint8)

        def view(position: int, found: Decoded | str) -> _Seen | str:
            if isinstance(found, str):
                return found
            image = _resized(found.image, self._size)
            return _Seen(found.size, not self._describe(image, described, features[position]))

        return view

    def _describe(self, image: Image, described: _Described, features: Float32Array) -> bool:
        """Write the features of the patches of a working image, unless it is black."""
        describe_pixels(image, *described, circular=self.params.lbp == "circular")
        counts = _kernels.count_patches(*described, self._grid, self._uniform)
        if not counts[:, _BRIGHT].any():
            return False
        _kernels.embed_counts(counts, self.params.color_weight, features)
        return True

    def _compare(self, encoding: str, size: tuple[int, int]) -> None:
        """Count a change of size or encoding."""
        last_encoding, last_size = self._last or (encoding, size)
        if encoding != last_encoding:
            self.changes[ENCODING_CHANGES] += 1
        if size != last_size:
            self.changes[SIZE_CHANGES] += 1
        self._last = encoding, size


def working_image(frame: Frame, params: ImageParams) -> Image | None:
    """Return the image that features are taken from.

    Parameters
    ----------
    frame : Frame
        As recorded.
    params : ImageParams
        ``image_size`` and ``image_decode``.

    Returns
    -------
    ndarray of shape (H, W, 3), uint8, or None
        BGR, of the size ``params.image_size``; None if the image cannot be decoded.
    """
    image = decode_frame(frame, _smallest(params))
    return None if image is None else _resized(image, params.width_height())


def _smallest(params: ImageParams) -> tuple[int, int] | None:
    """Return the size that a JPEG must keep when it is decoded; None: its own."""
    return params.width_height() if params.image_decode == "scaled" else None


def _resized(image: Image, size: tuple[int, int]) -> Image:
    """Bring an image to a width and height."""
    import cv2  # noqa: PLC0415  # only where there are images

    if (image.shape[1], image.shape[0]) == size:
        return image
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)
