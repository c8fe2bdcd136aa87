"""Scans, odometry, commands and the place of the scanner as messages, for ROS and JSON."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from mpap_cli.observations import NS_PER_S, Float32Array, Float64Array
from mpap_cli.simulation.laser import Scanner
from mpap_cli.simulation.robot import STEP_NS, Track

Fields = dict[str, Any]

LASER_FRAME = "laser"
_ODOM_DECIMALS = 5


def ros_header(stamp_ns: int, frame_id: str) -> Fields:
    """Return a std_msgs/Header.

    >>> ros_header(1_500_000_000, "laser")
    {'stamp': {'sec': 1, 'nanosec': 500000000}, 'frame_id': 'laser'}
    """
    sec, nanosec = divmod(stamp_ns, NS_PER_S)
    return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": frame_id}


def json_header(stamp_ns: int, frame_id: str) -> Fields:
    """Return the stamp and frame of a Foxglove message.

    >>> json_header(1_500_000_000, "laser")
    {'timestamp': {'sec': 1, 'nsec': 500000000}, 'frame_id': 'laser'}
    """
    sec, nsec = divmod(stamp_ns, NS_PER_S)
    return {"timestamp": {"sec": sec, "nsec": nsec}, "frame_id": frame_id}


def laser_scan(stamp_ns: int, ranges: Float32Array, scanner: Scanner) -> Fields:
    """Return a sensor_msgs/LaserScan."""
    return {
        "header": ros_header(stamp_ns, LASER_FRAME),
        "angle_min": scanner.angle_min,
        "angle_max": scanner.angle_min + (scanner.n_beams - 1) * scanner.increment_rad,
        "angle_increment": scanner.increment_rad,
        "scan_time": scanner.period_ns / NS_PER_S,
        "range_min": scanner.range_min_m,
        "range_max": scanner.range_max_m,
        "ranges": ranges,
    }


def foxglove_scan(stamp_ns: int, ranges: Float32Array, scanner: Scanner) -> Fields:
    """Return a foxglove.LaserScan, whose pose is the place of the scanner on the robot."""
    return {
        **json_header(stamp_ns, "base_link"),
        "pose": {
            "position": {"x": scanner.x_m, "y": scanner.y_m, "z": scanner.z_m},
            "orientation": _yaw(-scanner.forward_rad),
        },
        "start_angle": scanner.angle_min,
        "end_angle": scanner.angle_min + (scanner.n_beams - 1) * scanner.increment_rad,
        "ranges": ranges,
        "intensities": [],
    }


def scanner_transform(stamp_ns: int, scanner: Scanner) -> Fields:
    """Return a tf2_msgs/TFMessage from base_link to the frame of the scanner."""
    transform = {
        "header": ros_header(stamp_ns, "base_link"),
        "child_frame_id": LASER_FRAME,
        "transform": {
            "translation": {"x": scanner.x_m, "y": scanner.y_m, "z": scanner.z_m},
            "rotation": _yaw(-scanner.forward_rad),
        },
    }
    return {"transforms": [transform]}


def twist(speed: float, turn: float) -> Fields:
    """Return a geometry_msgs/Twist."""
    return {"linear": {"x": speed}, "angular": {"z": turn}}


class Odometer:
    """Wheel odometry: it counts a little too much and drifts.

    Parameters
    ----------
    start_ns : int
        Stamp of step 0.
    seed : int
        Of its errors.
    """

    def __init__(self, start_ns: int, seed: int) -> None:
        self._start_ns = start_ns
        self._rng = np.random.default_rng((seed, 5))
        self._gain = 1.0 + self._rng.normal(0.0, 0.02, 2)
        self._pose = np.zeros(3)

    def messages(self, track: Track) -> Iterator[tuple[int, Fields]]:
        """Yield stamp and nav_msgs/Odometry at every other step."""
        moving = np.abs(track.motion) > 0
        noise = self._rng.normal(0.0, (0.01, 0.03), track.motion.shape)
        motion = np.round(track.motion * self._gain + noise * moving, _ODOM_DECIMALS)
        poses = self._integrate(motion)
        for i in range((track.first_step + 1) % 2, len(poses), 2):
            stamp_ns = self._start_ns + (track.first_step + i) * STEP_NS
            yield stamp_ns, _odometry(stamp_ns, poses[i], motion[i])

    def _integrate(self, motion: Float64Array) -> Float64Array:
        """Return where the wheels think the robot is after each step."""
        step_s = STEP_NS / NS_PER_S
        heading = _add_up(self._pose[2], motion[:, 1] * step_s)
        x = _add_up(self._pose[0], motion[:, 0] * np.cos(heading) * step_s)
        y = _add_up(self._pose[1], motion[:, 0] * np.sin(heading) * step_s)
        poses = np.stack((x, y, heading), axis=1)
        self._pose = poses[-1]
        return np.round(poses, _ODOM_DECIMALS)


def _add_up(start: float, steps: Float64Array) -> Float64Array:
    """Return running sums, added one by one, so that blocks of any size give the same."""
    sums: Float64Array = np.cumsum(np.concatenate(([start], steps)))[1:]
    return sums


def _odometry(stamp_ns: int, pose: Float64Array, motion: Float64Array) -> Fields:
    x, y, heading = pose.tolist()
    speed, turn = motion.tolist()
    place = {"position": {"x": x, "y": y}, "orientation": _yaw(heading)}
    return {
        "header": ros_header(stamp_ns, "odom"),
        "child_frame_id": "base_link",
        "pose": {"pose": place},
        "twist": {"twist": twist(speed, turn)},
    }


def _yaw(angle: float) -> Fields:
    """Return the quaternion of a turn about z."""
    sine, cosine = math.sin(angle / 2), math.cos(angle / 2)
    return {"x": 0.0, "y": 0.0, "z": sine, "w": cosine}
