"""Images of a run of messages."""

import numpy as np

from mpap_cli.logs.files.runs import group_messages
from mpap_cli.logs.image_runs import read_frames
from mpap_cli.logs.raw import RawMessage, RawRun, Topic
from mpap_cli.logs.writing.encoding import RosEncoder

IMAGE = "sensor_msgs/msg/Image"
ENCODER = RosEncoder(2)
STAMP_NS = 7_000_000_005


def image(gray: int) -> bytes:
    """Return an image of one gray."""
    header = {"stamp": {"sec": 7, "nanosec": 5}}
    return ENCODER.encode(IMAGE, {"header": header, "data": np.full(20, gray, np.uint8)})


def run_of(*payloads: bytes) -> RawRun:
    """Put payloads behind one another, as a log has them."""
    kind = Topic("/camera", IMAGE, "cdr", 1, "", "")
    messages = (RawMessage(kind, 10 * n, payload) for n, payload in enumerate(payloads))
    ((run,),) = (group.runs for group in group_messages(messages))
    return run


def test_run_gives_its_images_and_counts_the_rest() -> None:
    """Images that are cut short do not stop the others; stamps are those wanted."""
    payloads = [image(n) for n in range(4)]
    run = run_of(payloads[0], payloads[1][:-1], payloads[2], payloads[3], b"")

    piece, skipped = read_frames(run)
    by_header, _ = read_frames(run, "header")

    assert [frame.payload[0] for frame in piece.frames] == [0, 2, 3]
    assert skipped == {"an image cut short": 1, "an image that is no plain CDR": 1}
    assert piece.recorded_ns.tolist() == piece.stamps_ns.tolist() == [0, 20, 30]
    assert [frame.stamp_ns for frame in piece.frames] == [0, 20, 30]
    assert by_header.recorded_ns.tolist() == [0, 20, 30]
    assert by_header.stamps_ns.tolist() == [STAMP_NS] * 3
    assert piece.n_bytes == 60


def test_some_images_of_a_piece() -> None:
    """Rows are named by numbers, by a slice, or yes and no."""
    piece, _ = read_frames(run_of(*(image(7) for _ in range(3))))

    for rows in (slice(1, None), np.array([1, 2]), np.array([False, True, True])):
        assert [frame.stamp_ns for frame in piece.rows(rows).frames] == [10, 20]
        assert piece.rows(rows).stamps_ns.tolist() == [10, 20]


def test_run_without_a_whole_image_is_an_empty_piece() -> None:
    """Nothing is left but the count."""
    piece, skipped = read_frames(run_of(b"", b""))

    assert (piece.frames, piece.stamps_ns.size, piece.n_bytes) == ((), 0, 0)
    assert skipped.total() == 2
