"""What is said of broken chunks: once each, with what is lost where that is known."""

import pytest

from mpap_cli.errors import LogError
from mpap_cli.logs.files.chunked.broken_chunks import BrokenChunks
from mpap_cli.logs.raw import Reading, Topic

TOPIC = Topic("/scan", "sensor_msgs/msg/LaserScan", "cdr", 9, "", "")


def test_losses_add_up_chunk_by_chunk() -> None:
    """A chunk counts once, however often it is read; an unknown channel counts, too."""
    reading = Reading()
    broken = BrokenChunks("a.mcap", 7, {1: TOPIC}, reading)

    broken.note(100, "its checksum is wrong", {1: 1000, 2: 3})
    broken.note(100, "its checksum is wrong", {1: 1000, 2: 3})
    broken.note(900, "it is cut off", {1: 5})

    (damage,) = reading.damage
    assert (damage.kind, damage.count) == ("chunk", 2)
    assert damage.lost == {("/scan", "sensor_msgs/msg/LaserScan"): 1005, ("", ""): 3}
    assert damage.text == (
        "a.mcap: 2 of 7 chunks damaged and left out, 1,008 messages lost "
        "(at byte 900: it is cut off)"
    )


@pytest.mark.parametrize(
    ("losses", "told"),
    [
        ([None], "left out (at"),
        ([{}], "left out, 0 messages lost (at"),
        ([{1: 1}], "left out, 1 message lost (at"),
        ([None, {1: 4}], "left out, at least 4 messages lost (at"),
    ],
)
def test_what_is_not_known_is_not_told(losses: list[dict[int, int] | None], told: str) -> None:
    """A chunk without an index may have held anything."""
    reading = Reading()
    broken = BrokenChunks("a.bag", 7, {1: TOPIC}, reading)

    for offset, lost in enumerate(losses):
        broken.note(offset, "its head is broken", lost)

    assert told in reading.damage[0].text


def test_strict_reading_ends_at_the_first() -> None:
    """It is an error then."""
    broken = BrokenChunks("a.bag", 7, {}, Reading(strict=True))

    with pytest.raises(LogError, match="1 of 7 chunks damaged and left out"):
        broken.note(5, "its head is broken", None)
