"""The distribution that an MCAP file or the metadata.yaml of a folder names."""

from pathlib import Path

import pytest
from mcap.writer import Writer

from mpap_cli.errors import LogError
from mpap_cli.logs.files.mcap_files.mcap import open_mcap
from mpap_cli.logs.raw import Reading
from mpap_cli.logs.reader import open_log

# younger than humble, which is taken where the log names no distribution
EVENT = "service_msgs/msg/ServiceEventInfo"
SERIALIZED = "version: 9\nstorage_identifier: mcap\ncustom_data: ~\nros_distro: jazzy\n"
TOLD = {
    "in a word": ("rosbag2", {"ROS_DISTRO": "jazzy"}),
    "in the copy of metadata.yaml": ("rosbag2", {"serialized_metadata": SERIALIZED}),
}
UNTOLD = {
    "by others": ("robot", {"ROS_DISTRO": "jazzy"}),
    "not at all": ("rosbag2", {"serialized_metadata": "version: 5\n"}),
}


def write_event(path: Path, name: str, metadata: dict[str, str]) -> Path:
    """Write one message of a type without a definition."""
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2")
        channel = writer.register_channel(
            "/a", "cdr", writer.register_schema(EVENT, "ros2msg", b"")
        )
        writer.add_message(channel, 5, b"\0\1\0\0\1" + bytes(39), 5)
        writer.add_metadata("rosbag2", {"compression_mode": ""})
        writer.add_metadata(name, metadata)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap forgot the type
    return path


def event_in(path: Path) -> object:
    """Decode the message."""
    with open_log(path) as reader:
        (message,) = reader.messages({"/a"})
        return vars(reader.decode(message))["event_type"]


@pytest.mark.parametrize("told", TOLD)
def test_distribution_that_an_mcap_file_names(tmp_path: Path, told: str) -> None:
    """Its types are used where the file does not define them."""
    path = write_event(tmp_path / "a.mcap", *TOLD[told])

    assert event_in(path) == 1


@pytest.mark.parametrize("untold", UNTOLD)
def test_distribution_that_an_mcap_file_does_not_name(tmp_path: Path, untold: str) -> None:
    """Then it is humble."""
    path = write_event(tmp_path / "a.mcap", *UNTOLD[untold])

    with pytest.raises(LogError, match=r"name the folder of its \.msg file"):
        event_in(path)


def test_distribution_that_metadata_yaml_names(tmp_path: Path) -> None:
    """It outranks that of the files."""
    write_event(tmp_path / "a.mcap", "rosbag2", {"ROS_DISTRO": "foxy"})
    (tmp_path / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  version: 9\n  relative_file_paths: [a.mcap]\n"
        "  ros_distro: jazzy\n",
        encoding="utf-8",
    )

    assert event_in(tmp_path) == 1


@pytest.mark.parametrize("change", range(1, 60, 7))
def test_metadata_that_are_broken(tmp_path: Path, change: int) -> None:
    """The file is read as if they were not there."""
    path = write_event(tmp_path / "a.mcap", *TOLD["in a word"])
    content = bytearray(path.read_bytes())
    place = content.index(b"ROS_DISTRO")
    content[place - 30 + change] ^= 0xFF
    path.write_bytes(content)

    file = open_mcap(path, Reading())

    assert file.ros_distro in {"", "jazzy"} or not file.ros_distro.isascii()
    assert file.n_messages == 1
