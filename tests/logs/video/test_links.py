"""Packets hold on to those that they are decoded after, and to no more."""

from collections.abc import Callable
from typing import Any

import pytest

from mpap_cli.logs.raw import LogReader, PayloadError, RawMessage
from mpap_cli.logs.replay import Replay, ReplayOptions
from mpap_cli.logs.topics import choose_roles
from mpap_cli.logs.video import links as links_module
from mpap_cli.logs.video.links import PacketLinks, links_before, read_linked
from mpap_cli.observations import NS_PER_S, Frame
from mpap_cli.params import BumperParams
from tests.videos import FOXGLOVE, KEY_EVERY, N_PICTURES, as_json, linked, packets_of

MakeLog = Callable[..., LogReader]
STEP_NS = NS_PER_S // 5
BROKEN = b"{}"


def line(frame: Frame) -> list[int]:
    """Return the numbers of the packets that a frame holds on to, its own last."""
    numbers = []
    one: Frame | None = frame
    while one is not None:
        assert one.place is not None
        numbers.append(one.place.number)
        one = one.place.before
    return numbers[::-1]


def places(frames: list[Frame]) -> list[tuple[int, bool]]:
    """Return how many packets each frame holds on to, and whether the first opens the video."""
    return [(len(line(frame)), frame.place is not None and frame.place.opened) for frame in frames]


@pytest.fixture
def video(make_log: MakeLog) -> LogReader:
    """Return a log of a video at 5 Hz whose packet 10 is broken."""
    packets = enumerate(packets_of("h264"))
    payloads = [
        as_json(packet, "h264", n * STEP_NS) if n != 10 else BROKEN for n, packet in packets
    ]
    events: list[Any] = [
        ("/camera", FOXGLOVE, n * STEP_NS, {"payload": payload})
        for n, payload in enumerate(payloads)
    ]
    return make_log(events, ros_version=0)


def message_at(reader: LogReader, stamp_ns: int) -> RawMessage:
    """Return the message of a stamp."""
    (message,) = reader.messages({"/camera"}, stamp_ns, stamp_ns + 1)
    return message


def test_line_goes_back_to_the_keyframe() -> None:
    """Each keyframe begins another."""
    frames = linked("vp9", packets_of("vp9"))

    assert places(frames) == [(n % KEY_EVERY + 1, True) for n in range(N_PICTURES)]
    assert line(frames[10]) == [8, 9, 10]


def test_line_before_the_first_keyframe_is_not_opened() -> None:
    """It still tells in which order packets follow one another."""
    frames = linked("vp9", packets_of("vp9")[5:10])

    assert places(frames) == [(1, False), (2, False), (3, False), (1, True), (2, True)]


def test_lost_message_and_another_codec_break_the_line() -> None:
    """The number goes on, so that the gap is seen; stills have no place."""
    links = PacketLinks()
    still = Frame(0, "mono8", 1, 1, 1, b"\0")

    first = linked("h264", packets_of("h264")[:2], links)
    links.skip()
    second = linked("h264", packets_of("h264")[3:5], links)
    other = linked("vp9", packets_of("vp9")[1:2], links)
    unplaced = links.link(still)
    last = linked("vp9", packets_of("vp9")[2:3], links)

    assert [line(frame) for frame in (*first, *second, *other, *last)] == [
        [0], [0, 1], [3], [3, 4], [5], [7]
    ]  # fmt: skip
    assert unplaced is still
    assert not links.opened


def test_line_is_cut_by_count_and_by_size(monkeypatch: pytest.MonkeyPatch) -> None:
    """A video of one keyframe would be kept whole otherwise."""
    packets = [packets_of("h264")[0], *[packets_of("h264")[1]] * 9]
    monkeypatch.setattr(links_module, "MOST_LINKED", 4)
    by_count = places(linked("h264", packets))

    monkeypatch.setattr(links_module, "MOST_LINKED", 1024)
    monkeypatch.setattr(links_module, "MOST_LINKED_BYTES", len(packets[0]) + 1)
    by_size = places(linked("h264", packets))

    assert by_count[:6] == [(1, True), (2, True), (3, True), (4, True), (1, False), (2, False)]
    assert by_size[:4] == [(1, True), (2, True), (1, False), (2, False)]


def test_one_image_is_read_with_what_it_needs(video: LogReader) -> None:
    """Back to the keyframe, which may lie longer ago than the first look."""
    frame = read_linked(video, message_at(video, 7 * STEP_NS))
    behind = read_linked(video, message_at(video, 12 * STEP_NS))

    assert places([frame]) == [(8, True)]
    assert places([behind]) == [(2, False)]
    with pytest.raises(PayloadError, match=r"^log\.mcap: /camera: an image that does not follow"):
        read_linked(video, message_at(video, 10 * STEP_NS))


def test_nothing_is_read_where_nothing_is_needed(video: LogReader) -> None:
    """From the start of a log, and of images that are no video."""
    (topic,) = video.topics
    still = type(topic)("/camera", "sensor_msgs/msg/Image", "cdr", 9, "", "")

    assert not links_before(video, topic, None).opened
    assert not links_before(video, still, 9 * STEP_NS).opened
    assert links_before(video, topic, 9 * STEP_NS).opened


def test_stretch_of_a_log_begins_with_the_keyframe_before(video: LogReader) -> None:
    """Its first image can be decoded; a broken message is counted and breaks the line."""
    roles = choose_roles(video)
    options = ReplayOptions(start="1.0", sensors=frozenset({"image"}))
    replay = Replay(video, roles, BumperParams(), options)

    frames = [frame for batch in replay for frame in batch.frames]

    assert [frame.stamp_ns // STEP_NS for frame in frames] == [5, 6, 7, 8, 9, *range(11, 20)]
    assert [count for count, _ in places(frames)] == [6, 7, 8, 1, 2, 1, 2, 3, 4, 5, 1, 2, 3, 4]
    assert replay.skipped == {f"an image that does not follow {FOXGLOVE}": 1}
