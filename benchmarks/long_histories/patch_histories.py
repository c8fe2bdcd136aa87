"""Many hours with a camera: images of the simulator's worlds, seen again and again.

Images take too long to draw for hours of them. A few minutes are driven in several worlds
with several surfaces and lights, and their patches kept; a history is one way after the
other through what was seen there, with fresh noise.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.long_histories.histories import (
    HOUR_NS,
    HZ,
    KINDS,
    START_NS,
    STEPS,
    Visits,
    bumps_of,
    presses_of,
    stamps_of,
)
from mpap_cli.features.images.patch_features import PatchEmbedder
from mpap_cli.observations import (
    NS_PER_S,
    Bump,
    Float32Array,
    Float64Array,
    Frame,
    PatchBlock,
    PoseBlock,
    Press,
)
from mpap_cli.params import ImageParams
from mpap_cli.simulation.camera import Camera
from mpap_cli.simulation.robot import STEP_NS, Contact, Track, Walker
from mpap_cli.simulation.settings import PLACES

_N_VIEWS = 8
_VIEW_S = 60
_LOOKS = (("a", "day"), ("b", "day"), ("a", "evening"), ("c", "day"))
_SIZE = (320, 240)
# Roots of counts are off by half, whatever they are; some hundred pixels of a patch are new.
_NOISE = 0.5 / np.sqrt(500.0)
_N_NOISE = 1 << 20
_GAP_NS = 3 * NS_PER_S


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """One way through a place: what :class:`AppearanceModel` learns from."""

    patches: PatchBlock
    poses: PoseBlock
    bumps: tuple[Bump, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _View:
    """A drive: features (n, n_patches, d) and poses (n, 3); presses count from its start."""

    features: Float32Array
    poses: Float64Array
    presses: tuple[Press, ...]


def draw_views(folder: Path) -> Path:
    """Drive through the places with a camera, once, and keep the features of the patches."""
    path = folder / "views.npz"
    if not path.exists():
        np.savez(path, *[array for number in range(_N_VIEWS) for array in _drive(number)])
    return path


def _drive(number: int) -> tuple[Float32Array, Float64Array, Float64Array]:
    """Return features, poses, and the steps (k, 2) of the contacts of a drive."""
    place = PLACES[KINDS[number % len(KINDS)]]
    world = place.build(np.random.default_rng((number, 0)))
    walker = Walker(world, place.camera_habits, number)
    track = walker.advance(_VIEW_S * NS_PER_S // STEP_NS)
    camera = Camera(world, _SIZE, _LOOKS[number // 2 % len(_LOOKS)], 1 / HZ, (number, number))
    embedder = PatchEmbedder(ImageParams())
    poses, turns = track.poses[::STEPS], track.motion[::STEPS, 1].tolist()
    features = [
        embedder.transform([_frame(camera, pose, turn)]).features
        for pose, turn in zip(poses, turns, strict=True)
    ]
    return np.concatenate(features), poses, _spans(walker.contacts, track)


def _frame(camera: Camera, pose: Float64Array, turn_radps: float) -> Frame:
    image = camera.take(pose, turn_radps, None).image
    return Frame(0, "bgr8", *_SIZE, 3 * _SIZE[0], image.tobytes())


def _spans(contacts: list[Contact], track: Track) -> Float64Array:
    presses = presses_of(contacts, track, 0)
    return np.array([(one.start_ns, one.end_ns) for one in presses], np.float64).reshape(-1, 2)


class PatchHistory:
    """Ways through what was seen, for ever.

    Parameters
    ----------
    path : Path
        What :func:`draw_views` wrote.
    """

    def __init__(self, path: Path) -> None:
        with np.load(path) as found:
            arrays = [found[name] for name in found.files]
        self._views = [
            _View(features, poses, tuple(Press(int(start), int(end)) for start, end in spans))
            for features, poses, spans in zip(*[iter(arrays)] * 3, strict=True)
        ]
        self._rng = np.random.default_rng(21)
        self._noise = self._rng.normal(0.0, _NOISE, _N_NOISE).astype(np.float32)
        self._visits = Visits(len(self._views))

    def hour(self, hour: int) -> Iterator[Way]:
        """Yield the ways of an hour, in time order; to be asked for hour after hour."""
        after_ns, end_ns = hour * HOUR_NS, (hour + 1) * HOUR_NS
        while after_ns + _VIEW_S * NS_PER_S <= end_ns:
            view = self._views[self._visits.next_place(after_ns)]
            way = self._way(view, START_NS + after_ns)
            after_ns += int(way.patches.stamps_ns[-1]) - START_NS - after_ns + _GAP_NS
            yield way

    def _way(self, view: _View, start_ns: int) -> Way:
        """Go along a view from anywhere in its first half to its end."""
        n_images = len(view.features)
        first = int(self._rng.integers(n_images // 2))
        stamps_ns = stamps_of(start_ns, n_images - first)
        begin_ns = first * STEPS * STEP_NS
        presses = [
            Press(one.start_ns - begin_ns + start_ns, one.end_ns - begin_ns + start_ns)
            for one in view.presses
            if one.start_ns > begin_ns
        ]
        features = self._seen_again(view.features[first:])
        kept = np.arange(len(stamps_ns))
        return Way(
            PatchBlock(stamps_ns, features, kept),
            PoseBlock(stamps_ns, view.poses[first:]),
            bumps_of(presses, start_ns - 1, int(stamps_ns[-1])),
        )

    def _seen_again(self, features: Float32Array) -> Float32Array:
        """Return features with fresh noise: bins that were empty stay so."""
        seen = np.empty_like(features)
        size = features[0].size
        for image, before in enumerate(features):
            at = int(self._rng.integers(_N_NOISE - size))
            noise = self._noise[at : at + size].reshape(before.shape)
            seen[image] = np.abs(before + noise * (before > 0))
        seen /= np.sqrt(np.einsum("ipd,ipd->ip", seen, seen))[:, :, None]
        return seen
