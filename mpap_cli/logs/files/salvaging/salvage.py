"""Files of chunks without an index: read through once, so that all that is whole is used."""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import BinaryIO, NamedTuple

import numpy as np

from mpap_cli.logs.files.chunked.chunks import (
    BrokenRecordError,
    ChunkFormat,
    Index,
    Span,
    file_size,
    make_index,
)
from mpap_cli.logs.files.runs import MAX_STAMP_NS
from mpap_cli.logs.files.salvaging.resync import CHAIN, find_in_file
from mpap_cli.logs.raw import Topic
from mpap_cli.logs.remote.range_stream import NotInPlaceError, RangeStream
from mpap_cli.observations import IntArray

RUN_BYTES = 1 << 20
"""Records outside chunks are taken together up to about that size."""

_EVERY = np.empty(0, np.int64)


class Scanned(NamedTuple):
    """What was found in a file; ``whole`` tells if the file goes on as it should to its end.

    ``stop`` is the byte where reading ended, or the first of the broken places.
    """

    found: Index
    whole: bool
    stop: int
    n_gaps: int

    @property
    def n_messages(self) -> int:
        """Return how many messages there are."""
        return sum(topic.n_messages for topic in self.found.channels.values())

    @property
    def problem(self) -> str:
        """Say where the file is broken, and what is used."""
        if self.n_gaps:
            places = f"{self.n_gaps:,} places, first" if self.n_gaps > 1 else "one place,"
            used = f"the {self.n_messages:,} whole messages around are used"
            return f"is broken at {places} at byte {self.stop:,}; {used}"
        used = f"the {self.n_messages:,} whole messages before are used"
        return f"is cut off or broken at byte {self.stop:,}; {used}"


class Piece(NamedTuple):
    """One record of a file: chunk, loose, other, broken, or end; ``end`` may lie behind the file.

    ``sure`` tells if its size stands there twice and fits; ``told`` is what the records behind
    a chunk say of it, which then belong to it, None if they are not all there or do not agree.
    """

    kind: str
    offset: int
    end: int
    sure: bool = False
    told: Span | None = None


class FileFormat(NamedTuple):
    """How a container puts its records into a file.

    ``first`` is where they begin, ``start`` matches wherever one might; ``piece_at`` returns
    the record that begins at a place, None if none does; ``describe`` takes in a record that
    is no message, of a kind at a place in unpacked records, and ``described`` has every channel
    so far; ``channels`` returns the topics of these.
    """

    layout: ChunkFormat
    first: int
    start: re.Pattern[bytes]
    piece_at: Callable[[BinaryIO, int], Piece | None]
    describe: Callable[[int, bytes, int], None]
    described: Mapping[int, object]
    channels: Callable[[], dict[int, Topic]]


@dataclass(slots=True)
class _Tally:
    """What is known of a file so far."""

    spans: list[Span] = field(default_factory=list)
    broken: dict[int, str] = field(default_factory=dict)
    gaps: list[int] = field(default_factory=list)
    whole: bool = False
    stop: int = 0

    def keep(self, span: Span, messages: IntArray) -> None:
        """Keep the span that was read, with its counts and stamps."""
        messages = messages[:, messages[1] <= MAX_STAMP_NS]
        if messages.size:
            channels, n_messages = np.unique(messages[0], return_counts=True)
            counts = Counter(dict(zip(channels.tolist(), n_messages.tolist(), strict=True)))
            first, last = int(messages[1].min()), int(messages[1].max())
            made = Span(span.offset, first, last, counts, span.loose_bytes, span.cut)
            self.spans.append(made)

    def spans_of(
        self, pieces: Iterator[Piece], file_size: int
    ) -> Iterator[tuple[Span, Span | None]]:
        """Join records outside chunks into runs; chunks stay alone, with what is told of them."""
        begin = end = 0
        for piece in pieces:
            cut = piece.end > file_size
            joins = piece.kind == "loose" and not cut
            if begin < end and not (joins and piece.offset == end and end - begin < RUN_BYTES):
                yield Span(begin, 0, 0, None, end - begin), None
                begin = end
            if joins:
                begin, end = (begin if begin < end else piece.offset), piece.end
            elif piece.kind == "chunk":
                yield Span(piece.offset, 0, 0, None, cut=cut), piece.told
            elif piece.kind == "broken":
                self.gaps.append(piece.offset)
            self.whole = piece.kind == "end"
            self.stop = piece.offset if cut else piece.end
        if begin < end:
            yield Span(begin, 0, 0, None, end - begin), None


def scan(stream: BinaryIO, form: FileFormat) -> Scanned:
    """Go through a file and make the index that it lacks.

    Of a chunk that is followed by an index of its own, what that says is taken; the chunk is
    unpacked when it is read, not before, and seen to be broken then.

    Parameters
    ----------
    stream : BinaryIO
        The file.
    form : FileFormat
        Of its container.

    Raises
    ------
    NotInPlaceError
        If the file is fetched piece by piece.
    """
    if isinstance(stream, RangeStream):
        msg = "it has no index, or a broken one"
        raise NotInPlaceError(msg)
    tally = _Tally()
    for span, told in tally.spans_of(_pieces(stream, form), file_size(stream)):
        if told is not None and (told.n_messages or {}).keys() <= form.described.keys():
            tally.spans.append(told)
            continue
        records, problem = form.layout.load(stream, span)
        found, whole = form.layout.walk(records, _EVERY)
        if not whole:
            problem = problem or "a record in it is broken"
        for kind, place in found[:2, found[0] < 0].T.tolist():
            try:
                form.describe(-1 - kind, records, place)
            except BrokenRecordError as err:
                problem = problem or str(err)
        if problem and not span.cut:
            tally.broken[span.offset] = problem
        tally.keep(span, found[:, found[0] >= 0])
    index = make_index(form.channels(), tally.spans, broken=tally.broken)
    stop = tally.gaps[0] if tally.gaps else tally.stop
    return Scanned(index, tally.whole and not tally.gaps, stop, len(tally.gaps))


def _pieces(stream: BinaryIO, form: FileFormat) -> Iterator[Piece]:
    """Yield the records of a file up to its end; what is broken between them is one piece."""
    offset, size = form.first, file_size(stream)
    held: Piece | None = None
    while offset <= size and not (held and held.kind == "end"):
        piece = form.piece_at(stream, offset)
        if piece is not None and (piece.end <= size or piece.sure):
            if held:
                yield held
            held, offset = piece, piece.end
            continue
        # a length that is too large swallows what follows, so the last record is suspect
        suspect = held if held and not held.sure else None
        begin = suspect.offset if suspect else offset
        following = _find(stream, begin + 1, form)
        is_wrong = suspect is not None and following is not None and following < suspect.end
        if held and not is_wrong:
            yield held
            begin = offset
        if following is None:
            if piece is not None:
                yield piece
            return
        yield Piece("broken", begin, following)
        held, offset = None, following
    if held:
        yield held


def _find(stream: BinaryIO, offset: int, form: FileFormat) -> int | None:
    """Return where records go on behind a broken one; None if they do not."""
    size = file_size(stream)

    def goes_on(stream: BinaryIO, place: int) -> bool:
        for _ in range(CHAIN):
            piece = form.piece_at(stream, place)
            if piece is None:
                return False
            if piece.kind in {"chunk", "end"} or piece.end == size:
                return True
            if piece.end > size:
                return False
            place = piece.end
        return True

    return find_in_file(stream, offset, form.start, goes_on)
