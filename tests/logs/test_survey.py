"""What is settled before a log is replayed."""

import logging
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from mpap_cli.logs.raw import LogReader
from mpap_cli.logs.survey import BEAM_CODES, survey_log
from mpap_cli.logs.topics import choose_roles

MakeLog = Callable[..., LogReader]
Event = tuple[str, str, int, dict[str, Any]]

LASER_SCAN = "sensor_msgs/msg/LaserScan"
TURNED = {
    "header": {"frame_id": "base_link"},
    "child_frame_id": "laser",
    "transform": {"rotation": {"z": 1.0}},
}


def scan_event(stamp: int, ranges: list[float], **fields: Any) -> Event:
    """Return one scan of a metre a beam."""
    limits = {"range_min": 0.1, "range_max": 5.0, "angle_increment": 0.1}
    header = {"header": {"frame_id": "laser"}}
    return "/scan", LASER_SCAN, stamp, {**header, **limits, "ranges": ranges, **fields}


def tf_event(stamp: int = 0) -> Event:
    """Return the transform of a scanner that looks backwards."""
    return "/tf_static", "tf2_msgs/msg/TFMessage", stamp, {"transforms": [TURNED]}


def test_forward_comes_from_the_transforms(make_log: MakeLog) -> None:
    """A scanner turned by half a turn sees ahead at pi."""
    reader = make_log([tf_event(), scan_event(1, [1.0, 2.0])])

    survey = survey_log(reader, choose_roles(reader))

    assert survey.forward_rad == pytest.approx(math.pi)
    assert survey.forward_source == "tf"


def test_the_option_goes_before_the_transforms(make_log: MakeLog) -> None:
    """A direction that is given is an angle in the frame of the scanner."""
    reader = make_log([tf_event(), scan_event(1, [1.0, 2.0])])

    survey = survey_log(reader, choose_roles(reader), -math.pi / 2)

    assert (survey.forward_rad, survey.forward_source) == (-math.pi / 2, "option")


@pytest.mark.parametrize("frame", ["base_link", "/base_footprint", "robot1/base_link"])
def test_in_the_frame_of_the_robot_angle_0_is_ahead(
    make_log: MakeLog, caplog: pytest.LogCaptureFixture, frame: str
) -> None:
    """No transform is needed, and none is said to have told it."""
    caplog.set_level(logging.INFO)
    reader = make_log([scan_event(1, [1.0, 2.0], header={"frame_id": frame})])

    survey = survey_log(reader, choose_roles(reader))

    assert (survey.forward_rad, survey.forward_source) == (0.0, "frame")
    assert not caplog.records


def test_without_transforms_angle_0_is_ahead(
    make_log: MakeLog, caplog: pytest.LogCaptureFixture
) -> None:
    """The assumption is told in one line."""
    caplog.set_level(logging.INFO)
    reader = make_log([scan_event(1, [1.0, 2.0])])

    survey = survey_log(reader, choose_roles(reader))

    assert (survey.forward_rad, survey.forward_source) == (0.0, "assumed")
    (record,) = caplog.records
    assert record.getMessage() == (
        "log.mcap: no transform from the robot to its scanner (frame 'laser'); angle 0 is taken "
        "as straight ahead, --forward DEG says otherwise"
    )


def test_log_without_scans_has_no_geometry(
    make_log: MakeLog, caplog: pytest.LogCaptureFixture
) -> None:
    """Nothing is said of a scanner that is not there."""
    caplog.set_level(logging.INFO)
    reader = make_log([tf_event()])

    survey = survey_log(reader, choose_roles(reader))

    assert (survey.geometry, survey.range_max, survey.no_return_shares) == (None, None, {})
    assert not caplog.records


def test_shares_of_beam_codes_add_up(make_log: MakeLog) -> None:
    """Each beam has one code; -inf and 0 are codes of their own."""
    ranges = [0.0, math.nan, math.inf, -math.inf, -1.0, 5.5, 0.05, 0.1, 1.0, 5.0]
    reader = make_log([tf_event(), scan_event(1, ranges), scan_event(2, [2.0] * 10)])

    survey = survey_log(reader, choose_roles(reader))

    shares = survey.no_return_shares
    assert tuple(shares) == BEAM_CODES
    assert [shares[code] for code in BEAM_CODES[:-1]] == [pytest.approx(0.05)] * 7
    assert shares["valid"] == pytest.approx(0.65)
    assert survey.range_max is None


@pytest.mark.parametrize("range_max", [0.0, 0.1, math.nan, math.inf])
def test_unusable_range_max_is_replaced(
    make_log: MakeLog, caplog: pytest.LogCaptureFixture, range_max: float
) -> None:
    """The 99 % quantile of the returns stands in, so that one stray return does not count."""
    ranges = [*np.linspace(1.0, 4.0, 398), 60.0, math.inf]
    reader = make_log([tf_event(), scan_event(1, ranges, range_max=range_max)])

    survey = survey_log(reader, choose_roles(reader))

    assert survey.range_max == pytest.approx(4.0, abs=0.05)
    assert survey.no_return_shares["above range_max"] == 0.0
    (message,) = [record.getMessage() for record in caplog.records]
    assert message.startswith("log.mcap: the scans give no usable range_max (")
    assert "m, from its first scans, is taken; --max-range M" in message


def test_no_return_at_all_leaves_range_max_open(
    make_log: MakeLog, caplog: pytest.LogCaptureFixture
) -> None:
    """Without returns there is nothing to go by."""
    reader = make_log([tf_event(), scan_event(1, [math.inf, 0.0], range_max=0.0)])

    assert survey_log(reader, choose_roles(reader)).range_max is None
    assert "there is no return; --max-range M" in caplog.text


def test_broken_scans_do_not_count(make_log: MakeLog) -> None:
    """The geometry is that of the usual number of beams, whatever comes first."""
    events = [scan_event(stamp, [1.0] * 9) for stamp in (2, 3, 4)]
    broken: Event = ("/scan", LASER_SCAN, 0, {"payload": b"\x00\x01"})
    reader = make_log([tf_event(), broken, scan_event(1, [math.nan] * 4), *events])

    survey = survey_log(reader, choose_roles(reader))

    assert survey.geometry is not None
    assert survey.geometry.n_beams == 9
    assert survey.no_return_shares["valid"] == 1.0


def test_only_the_first_scans_are_read(make_log: MakeLog) -> None:
    """A long log is not read to its end."""
    reader: Any = make_log([tf_event(), *(scan_event(stamp, [1.0]) for stamp in range(2000))])

    survey_log(reader, choose_roles(reader))

    assert reader.n_read <= 600
