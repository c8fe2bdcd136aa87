"""The messages of the camera, image by image along the way of the robot."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from mpap_cli.observations import NS_PER_S, Float64Array
from mpap_cli.simulation.camera import Camera, Shot
from mpap_cli.simulation.camera_messages import (
    INFO_TOPIC,
    INFO_TYPE,
    Fields,
    camera_info,
    image_message,
    image_topic,
)
from mpap_cli.simulation.camera_truth import (
    CameraTruth,
    Sight,
    free_ahead,
    kind_shares,
    material_counts,
)
from mpap_cli.simulation.robot import STEP_NS, Contact, Habits, Track
from mpap_cli.simulation.settings import CameraParams, SimulationParams
from mpap_cli.simulation.world import World

_HALF_WIDTH_M = Habits().radius_m
# later than a step, so that images between two blocks do not come too late
_DELAY_NS = (STEP_NS, STEP_NS + 30_000_000)


class CameraSource:
    """Takes images at the camera's rate, between the steps of the robot as well.

    Parameters
    ----------
    world : World
        What there is to see.
    params : SimulationParams
        Seeds and start.
    camera : CameraParams
        Size, rate, encoding and looks.
    truth : CameraTruth
        Where the truth about the images goes.
    """

    def __init__(
        self, world: World, params: SimulationParams, camera: CameraParams, truth: CameraTruth
    ) -> None:
        self.n_taken = 0
        looks = (camera.textures, camera.light)
        seeds = (params.seed_of_world, params.seed)
        self._camera = Camera(world, camera.width_height(), looks, 1 / camera.hz, seeds)
        self._params = params
        self._hz = camera.hz
        self._encoding = camera.encoding
        self._topic, self._type = image_topic(camera.encoding)
        self._solid, _ = world.pick(solid=True)
        self._truth = truth
        self._delays = np.random.default_rng((params.seed, 9))
        self._before: Float64Array | None = None

    def topics(self) -> Iterator[tuple[str, str]]:
        """Yield name and type of the camera's topics."""
        yield INFO_TOPIC, INFO_TYPE
        yield self._topic, self._type

    def messages(
        self, track: Track, contacts: Sequence[Contact]
    ) -> Iterator[tuple[int, str, Fields]]:
        """Yield log time, topic and fields of what is taken up to the last step of a track.

        Parameters
        ----------
        track : Track
            The one after that of the last call.
        contacts : sequence of Contact
            All so far.
        """
        camera, is_ros1 = self._camera, self._params.is_ros1
        last_ns = (track.first_step + len(track.poses) - 1) * STEP_NS
        while (after_ns := round(self.n_taken * NS_PER_S / self._hz)) <= last_ns:
            step, part_ns = divmod(after_ns, STEP_NS)
            shot, sight = self._take(track, step, part_ns / STEP_NS, _foot(contacts, step))
            stamp_ns = self._params.start_stamp_ns + after_ns
            at_ns = stamp_ns + int(self._delays.integers(*_DELAY_NS))
            self._truth.add(at_ns, sight)
            self.n_taken += 1
            info = camera_info(stamp_ns, camera.size, camera.focal_px, is_ros1=is_ros1)
            yield at_ns, INFO_TOPIC, info
            quality = camera.light.jpeg_quality
            image = image_message(stamp_ns, shot.image, self._encoding, quality)
            yield at_ns, self._topic, image
        self._before = track.poses[-1]

    def _take(
        self, track: Track, step: int, part: float, foot_rad: float | None
    ) -> tuple[Shot, Sight]:
        """Take an image between a step and the next, and say what it truly shows."""
        i = step - track.first_step
        pose = track.poses[i] if i >= 0 or self._before is None else self._before
        turn_radps = float(track.motion[i + (part > 0), 1])
        if part > 0:
            way = track.poses[i + 1] - pose
            way[2] = math.remainder(way[2], math.tau)
            pose = pose + part * way
        shot = self._camera.take(pose, turn_radps, foot_rad)
        ahead_m = 0.0 if foot_rad is not None else free_ahead(self._solid, pose, _HALF_WIDTH_M)
        return shot, Sight(kind_shares(material_counts(shot.labels)), ahead_m)


def _foot(contacts: Sequence[Contact], step: int) -> float | None:
    """Return where a foot touches the robot at a step, if one does."""
    for contact in reversed(contacts):
        if contact.start_step <= step:
            touching = contact.cause == "foot" and step < contact.end_step
            return contact.bearing_rad if touching else None
    return None
