"""What ``info --format json`` prints: its keys in their order, each with its meaning."""

from typing import Annotated, TypedDict

from mpap_cli.systems.columns import LogName


class TopicFacts(TypedDict):
    """One topic of a log."""

    name: Annotated[str, "its name"]
    type: Annotated[str, "type of its messages"]
    messages: Annotated[int, "messages that can be read"]
    hz: Annotated[float | None, "messages per second of the log; null if it is very short"]
    role: Annotated[str | None, "`scan`, `image` or `bump` where it would be used"]
    bytes: Annotated[int | None, "size of its messages; null where no index tells"]


class BumpFacts(TypedDict):
    """The bumper; null where nothing tells of presses."""

    topic: Annotated[str | None, "topics that are used; null for presses from elsewhere"]
    type: Annotated[str | None, "type of the messages of the first"]
    semantics: Annotated[str, "`level`, `edge`, `pulse`, or where presses come from"]
    presses: Annotated[int, "number of presses"]
    scans_pressed: Annotated[int, "scans within a press"]
    pressed_s: Annotated[float, "seconds within a press"]


class ScanFacts(TypedDict):
    """The laser scans; null where none are used."""

    topic: Annotated[str, "topic that is used"]
    scans: Annotated[int, "scans that were read"]
    beams: Annotated[int, "beams of a scan"]
    no_return_share: Annotated[float, "share of beams without a valid range"]
    forward_deg: Annotated[float, "straight ahead in the frame of the scanner"]


class ImageFacts(TypedDict):
    """The camera; null where none is used."""

    topic: Annotated[str, "topic that is used"]
    images: Annotated[int, "images that can be read"]
    width: Annotated[int | None, "pixels of the first image; null if it is broken"]
    height: Annotated[int | None, "likewise"]
    encoding: Annotated[str | None, "`jpeg`, `rgb8`, `h264` ..."]


class LogFacts(TypedDict):
    """One log."""

    path: Annotated[str, "where it lies"]
    container: Annotated[str, "`bag`, `mcap`, `sqlite3`, `rosbag2/sqlite3` or `rosbag2/mcap`"]
    start_stamp_ns: Annotated[int, "time of the first message"]
    duration_s: Annotated[float, "seconds from the first message to the last"]
    messages: Annotated[int, "messages that can be read"]
    topics: Annotated[list[TopicFacts], "every topic"]
    bump: Annotated[BumpFacts | None, "the bumper"]
    scan: Annotated[ScanFacts | None, "the laser scans"]
    image: Annotated[ImageFacts | None, "the camera"]
    damage: Annotated[list[str], "what could not be read, one sentence each"]
    warnings: Annotated[list[str], "what is to be known, one sentence each"]
    can_learn: Annotated[str, "what could be learnt from it, in words"]


class ModelLogFacts(TypedDict):
    """One log that a model has learnt."""

    name: LogName
    scans: Annotated[int | None, "scans learnt from it; null where none were"]
    images: Annotated[int | None, "images learnt from it; null where none were"]
    presses: Annotated[int | None, "its presses; null without a bumper"]


class ModelFacts(TypedDict):
    """One model."""

    path: Annotated[str, "where it lies"]
    profile: Annotated[str, "`robust` or `paper`"]
    feature: Annotated[str, "value of a bin of a scan"]
    bins: Annotated[int, "number of bins of a scan"]
    clusters: Annotated[int | None, "clusters of scans; null where none were learnt"]
    meta_points: Annotated[int | None, "meta-points of scans"]
    image_clusters: Annotated[int | None, "clusters of patches; null where none were learnt"]
    exemplars: Annotated[int | None, "exemplars of patches"]
    logs: Annotated[list[ModelLogFacts], "the logs it was learnt from"]
