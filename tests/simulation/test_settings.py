"""Settings of a simulation are checked before anything is written."""

import math
from typing import Any

import pytest

from mpap_cli.errors import SettingError
from mpap_cli.observations import NS_PER_S
from mpap_cli.simulation.settings import SimulationParams


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"world": "moon"}, "world: found moon, expected one of indoor, outdoor"),
        ({"duration_s": 0.5}, r"duration-s: found 0\.5"),
        ({"duration_s": math.nan}, "duration-s: found nan"),
        ({"seed": -1}, "seed: found -1"),
        ({"world_seed": -2}, "seed: found -2"),
        ({"container": "tar"}, "container: found tar"),
        ({"compression": "rar"}, "compression: found rar"),
        ({"bumper": "horn"}, "bumper: found horn, expected one of kobuki"),
        ({"bumper": "pressed"}, "bumper: found pressed, expected one of kobuki"),
        ({"container": "mcap-json", "bumper": "kobuki"}, "bumper: .*expected one of pressed"),
        ({"container": "mcap-json", "no_return": "inf"}, "JSON cannot hold"),
        ({"no_return": "nan"}, "no-return: found nan, expected one of above-max"),
        ({"tf_topic": "/pose"}, "tf-topic: found /pose"),
        ({"forward_deg": 400.0}, r"forward-deg: found 400\.0"),
        ({"start_stamp_ns": -1}, "start-stamp-ns: found -1"),
        ({"start_stamp_ns": 2**31 * NS_PER_S}, "start-stamp-ns"),
    ],
)
def test_settings_that_do_not_fit_are_refused(settings: dict[str, Any], message: str) -> None:
    """A value that does not exist, or does not fit the others, is named with what would do."""
    with pytest.raises(SettingError, match=message):
        SimulationParams(**settings)


@pytest.mark.parametrize(
    ("container", "msgtype"),
    [
        ("bag", "kobuki_msgs/msg/BumperEvent"),
        ("mcap-ros1", "kobuki_msgs/msg/BumperEvent"),
        ("mcap", "kobuki_ros_interfaces/msg/BumperEvent"),
        ("mcap-json", "Bumper"),
    ],
)
def test_container_decides_the_type_of_the_bumper(container: str, msgtype: str) -> None:
    """A Kobuki has another message package in ROS1 than in ROS2; JSON has its own message."""
    params = SimulationParams(container=container)

    assert params.bumper_msgtype == msgtype
