"""Commands go through logs whose images are video."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from mpap_cli.features.images.video_decode import Picture, VideoDecoder
from tests.commands.camera_runs import SMALL
from tests.commands.running import bytes_of, done, mpap, rows_of
from tests.commands.video_logs import (
    N_IMAGES,
    VIDEO,
    image_topic,
    png_packets,
    recorded,
    video_packets,
    write_folder,
    write_mcap,
)
from tests.videos import KEY_EVERY, linked

INSTALL = 'pip install "mpap[video]" to read it'
Write = Callable[[Path], Path]


def decoded() -> list[Picture]:
    """Return the pictures of the video, decoded in a row."""
    frames = linked("h264", [packet for _, _, packet in video_packets()])
    found = dict(VideoDecoder().decode(frames))
    return [picture for _, picture in sorted(found.items()) if isinstance(picture, np.ndarray)]


def write_video(path: Path, kind: str = "protobuf", *, scans: bool = True) -> Path:
    """Write a log with the fixture's pictures as video."""
    return write_mcap(path, image_topic(kind), video_packets(), scans=scans)


WRITERS: dict[str, Write] = {
    "protobuf": lambda path: write_video(path / "day.mcap"),
    "json": lambda path: write_video(path / "day.mcap", "json"),
    "foxglove": lambda path: write_folder(path / "day", image_topic("foxglove"), video_packets()),
    "transport": lambda path: write_folder(path / "day", image_topic("transport"), video_packets()),
}


@pytest.fixture
def without_video(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let PyAV be missing."""
    monkeypatch.setattr("mpap_cli.logs.sensor_topics.find_spec", lambda _: None)


@pytest.mark.parametrize("kind", WRITERS)
def test_info_knows_video(tmp_path: Path, kind: str) -> None:
    """Size and codec are those of the first keyframe."""
    path = WRITERS[kind](tmp_path)

    page = done("info", path).out
    (facts,) = json.loads(done("info", path, "--format", "json").out)

    assert f"image: {VIDEO} (the only camera): 60 images, 320 x 240, h264" in page
    assert facts["image"]["encoding"] == "h264"
    assert facts["warnings"] == []


@pytest.mark.parametrize("kind", WRITERS)
def test_every_picture_is_met(tmp_path: Path, kind: str) -> None:
    """Whatever carries the packets."""
    path = WRITERS[kind](tmp_path)

    outcome = done("novelty", path, "-o", tmp_path / "out", *SMALL)

    rows = rows_of(tmp_path / "out" / "novelty" / "novelty.csv")
    assert sum(int(row["observations"]) for row in rows) == 36 * N_IMAGES
    assert "left out" not in outcome.err


def test_results_are_those_of_the_pictures(tmp_path: Path) -> None:
    """A video and PNG images of its pictures give the same bytes, tables and drawings alike."""
    video = write_video(tmp_path / "video" / "day.mcap")
    stills = write_mcap(tmp_path / "png" / "day.mcap", image_topic("png"), png_packets(decoded()))

    results = {}
    for log in (video, stills):
        out = tmp_path / f"out-{log.parent.name}"
        done("learn", log, "-o", out, *SMALL)
        done("predict", out, log, "--to-mcap", "-o", out)
        results[log.parent.name] = {
            **bytes_of(out / "learn"),
            **{f"predict-{name}": content for name, content in bytes_of(out / "predict").items()},
        }

    by_video, by_png = results["video"], results["png"]
    assert by_video.keys() == by_png.keys()
    drawings = {name for name in by_video if name.endswith(".png")}
    assert {"members.png", "exemplars-patches.png", "predict-annotated.png"} <= drawings
    told = {name for name in by_video if "settings" in name or "recording" in name}
    assert [name for name in by_video if by_video[name] != by_png[name] and name not in told] == []


def test_annotated_images_of_a_video_go_to_the_log(tmp_path: Path) -> None:
    """One for each picture, with its stamp, also where B-frames come out of order."""
    packets = video_packets("h264", 3)
    log = write_mcap(tmp_path / "day.mcap", image_topic("transport"), packets)
    done("learn", log, "-o", tmp_path, "--sensor", "image", *SMALL)

    done("predict", tmp_path, log, "--to-mcap", "-o", tmp_path)

    with (tmp_path / "predict" / "0-day.mcap.mcap").open("rb") as stream:
        messages = make_reader(stream).iter_messages(topics=["/mpap/annotated"])
        stamps_ns = [message.log_time for _, _, message in messages]
    assert stamps_ns == [recorded_ns for recorded_ns, _, _ in packets]


def test_pictures_by_the_stamps_of_their_headers(tmp_path: Path) -> None:
    """B-frames are recorded in another order than they were taken in."""
    log = write_mcap(tmp_path / "day.mcap", image_topic("transport"), video_packets("h264", 3))
    words = ("--time-source", "header", "--bump-from", "none")
    done("learn", log, "-o", tmp_path, "--sensor", "image", *words, *SMALL)

    done("predict", tmp_path, log, "-o", tmp_path, *words)

    rows = rows_of(tmp_path / "predict" / "decisions.csv")
    assert [int(row["stamp_ns"]) for row in rows] == list(recorded()[2])


def test_a_part_of_a_video_begins_with_its_first_picture(tmp_path: Path) -> None:
    """The packets that it builds on are read, though they lie before the start."""
    log = write_video(tmp_path / "day.mcap")
    others, _, stamps_ns = recorded()
    start_ns = min(others[0].stamp_ns, stamps_ns[0]) + 2_200_000_000
    done("learn", log, "-o", tmp_path, "--sensor", "image", *SMALL)

    done("predict", tmp_path, log, "-o", tmp_path, "--start", "2.2")

    rows = rows_of(tmp_path / "predict" / "decisions.csv")
    taken = [stamp_ns for stamp_ns in stamps_ns if stamp_ns >= start_ns]
    assert [int(row["stamp_ns"]) for row in rows] == taken
    assert (N_IMAGES - len(taken)) % KEY_EVERY > 0


def test_damage_within_a_video_is_told(tmp_path: Path) -> None:
    """Images are left out up to the next keyframe; the exit code says that some are missing."""
    packets = list(video_packets())
    packets[KEY_EVERY + 3] = (*packets[KEY_EVERY + 3][:2], bytes(40))
    log = write_mcap(tmp_path / "day.mcap", image_topic("foxglove"), packets[2:])

    outcome = mpap("novelty", log, "-o", tmp_path, *SMALL)

    assert outcome.code == 3
    rows = rows_of(tmp_path / "novelty" / "novelty.csv")
    n_lost = KEY_EVERY - 2 + KEY_EVERY - 3
    assert sum(int(row["observations"]) for row in rows) == 36 * (N_IMAGES - 2 - n_lost)
    assert "6 images left out: video before its first keyframe" in outcome.err
    assert "1 image left out: damaged video\n" in outcome.err
    assert "4 images left out: video between damage and the next keyframe" in outcome.err


@pytest.mark.usefixtures("without_video")
def test_without_the_extra_scans_are_learnt_and_it_is_said(tmp_path: Path) -> None:
    """One warning names what to install; info lists the topic and notes the same."""
    log = write_video(tmp_path / "day.mcap")

    outcome = done("learn", log, "-o", tmp_path)
    page = done("info", log).out

    told = [line for line in outcome.err.splitlines() if "mpap[video]" in line]
    assert told == [f"mpap: day.mcap: {VIDEO} carries video; {INSTALL}; images are left out"]
    assert f"note: no image topic is chosen: {VIDEO} carries video; {INSTALL}" in page
    assert f"  {VIDEO}" in page


@pytest.mark.usefixtures("without_video")
@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("learn", "--sensor", "image"), f"{VIDEO} carries video; {INSTALL}"),
        (("learn", "--image-topic", VIDEO), f"--image-topic {VIDEO}: this is video; {INSTALL}"),
        (("info", "--image-topic", VIDEO), f"--image-topic {VIDEO}: this is video; {INSTALL}"),
    ],
)
def test_without_the_extra_video_cannot_be_asked_for(
    tmp_path: Path, words: tuple[str, ...], text: str
) -> None:
    """One line, and exit code 2."""
    log = write_video(tmp_path / "day.mcap")
    out = () if words[0] == "info" else ("-o", tmp_path)

    outcome = mpap(words[0], log, *words[1:], *out)

    assert (outcome.code, outcome.err) == (2, f"mpap: day.mcap: {text}\n")


@pytest.mark.usefixtures("without_video")
@pytest.mark.parametrize("command", ["learn", "novelty"])
def test_without_the_extra_a_log_of_video_alone_is_refused(tmp_path: Path, command: str) -> None:
    """The error says what to install, not that scans are missing."""
    log = write_video(tmp_path / "day.mcap", scans=False)

    outcome = mpap(command, log, "-o", tmp_path)

    text = f"mpap: day.mcap: {VIDEO} carries video; {INSTALL}\n"
    assert (outcome.code, outcome.err) == (2, text)
