"""Which packets of a video are decoded before which."""

from collections.abc import Iterator
from dataclasses import replace

from mpap_cli.logs.frames import read_frame
from mpap_cli.logs.raw import LogReader, PayloadError, RawMessage, Topic
from mpap_cli.logs.video.openings import opens_video
from mpap_cli.logs.video.packets import VIDEO_TYPES
from mpap_cli.observations import NS_PER_S, VIDEO_ENCODINGS, Frame, PacketPlace

MOST_LINKED = 1024
MOST_LINKED_BYTES = 64 << 20
_LOOK_BACK_NS = tuple(seconds * NS_PER_S for seconds in (1, 8, 64))


class PacketLinks:
    """Gives each packet of a video its place: the packets that it is decoded after.

    A packet holds on to those before it, back to the last with which decoding can begin, so
    that its picture can be had at any time. Where that lies more than 1024 packets or
    64 MB back, the line is cut: from there on packets can only be decoded as they follow
    one another.
    """

    def __init__(self) -> None:
        self._number = -1
        self._last: Frame | None = None
        self._n_linked = self._n_bytes = 0
        self.opened = False

    def link(self, frame: Frame) -> Frame:
        """Return the next image with its place, if it is a packet of video."""
        self._number += 1
        if frame.encoding not in VIDEO_ENCODINGS:
            self._last = None
            return frame
        opens = opens_video(frame.encoding, frame.payload)
        full = self._n_linked >= MOST_LINKED or self._n_bytes >= MOST_LINKED_BYTES
        before = None if opens or full else self._last
        if before is not None and before.encoding != frame.encoding:
            before = None
        if before is None:
            self._n_linked = self._n_bytes = 0
        self.opened = opens or (before is not None and self.opened)
        self._n_linked += 1
        self._n_bytes += len(frame.payload)
        self._last = replace(frame, place=PacketPlace(self._number, before, self.opened))
        return self._last

    def skip(self) -> None:
        """Pass over a message that cannot be read: what follows it has lost its base."""
        self._number += 1
        self._last = None


def links_before(reader: LogReader, topic: Topic, until_ns: int | None) -> PacketLinks:
    """Link the packets of a video before a moment, from the last that opens it.

    Parameters
    ----------
    reader : LogReader
        An open log.
    topic : Topic
        Of images; nothing is read of any but video.
    until_ns : int or None
        Log time that is not reached; None: from the start of the log, where nothing is
        before.

    Returns
    -------
    PacketLinks
        Ready for the packets from that moment on; not ``opened`` if none that opens the
        video lies up to 64 s before.
    """
    links = PacketLinks()
    if until_ns is None or topic.msgtype not in VIDEO_TYPES:
        return links
    for back_ns in _LOOK_BACK_NS:
        links = PacketLinks()
        for _ in linked_frames(reader, topic, links, until_ns - back_ns, until_ns):
            pass
        if links.opened:
            break
    return links


def linked_frames(
    reader: LogReader,
    topic: Topic,
    links: PacketLinks,
    start_ns: int | None = None,
    end_ns: int | None = None,
) -> Iterator[Frame]:
    """Yield the images of a topic, start <= t < end in log time, each with its place."""
    for message in reader.messages({topic.name}, start_ns, end_ns):
        if message.topic.msgtype != topic.msgtype:
            continue
        try:
            frame = read_frame(reader, message)
        except PayloadError:
            links.skip()
        else:
            yield links.link(frame)


def read_linked(reader: LogReader, message: RawMessage) -> Frame:
    """Return the image of one message; a packet of video with those that it needs.

    Raises
    ------
    PayloadError
        If the message does not fit its type.
    """
    frame = read_frame(reader, message)
    return links_before(reader, message.topic, message.stamp_ns).link(frame)
