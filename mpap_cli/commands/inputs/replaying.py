"""Logs on their way through a command: read ahead in a thread, with progress."""

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from mpap_cli.commands.inputs.progress import Progress
from mpap_cli.commands.inputs.sources import Source
from mpap_cli.observations import NS_PER_S, Batch, Frame, PatchBlock
from mpap_cli.systems.stream import prefetch

Embed = Callable[[Sequence[Frame], int], PatchBlock]
Step = tuple[Batch, PatchBlock | None]
Part = tuple[Batch | None, PatchBlock | None]
P = TypeVar("P", Step, Part)

_PARTS = 8
_BATCHES_AHEAD = 2


def follow(
    source: Source, jobs: int, progress: Progress, verb: str, embed: Embed | None = None
) -> Iterator[Step]:
    """Replay a log, and tell how far it is.

    Parameters
    ----------
    source : Source
        An opened log.
    jobs : int
        2 or more: reading, decoding and image features run ahead in a thread of their own,
        which shares the images of a batch out among so many threads.
    progress : Progress
        Told after every batch.
    verb : str
        What is done with the log, such as learn.
    embed : callable, optional
        Turns the frames of a batch into patches, with so many threads.

    Yields
    ------
    tuple of Batch and PatchBlock
        The patches are None without ``embed``.
    """
    steps = (
        (batch, None if embed is None else embed(batch.frames, jobs)) for batch in source.batches()
    )
    ahead: Iterator[Step] = prefetch(steps, jobs, _BATCHES_AHEAD)
    yield from _told(ahead, source, progress, verb)


def follow_in_parts(
    source: Source, jobs: int, progress: Progress, verb: str, embed: Embed
) -> Iterator[Part]:
    """Replay a log as `follow` does, with the patches of a batch in parts.

    Who learns patches can begin with the first while the next are made.

    Parameters
    ----------
    source, jobs, progress, verb, embed
        As for :func:`follow`.

    Yields
    ------
    tuple of Batch and PatchBlock
        The batch comes with the last of its patches; with those before it stands None.
    """

    def parts() -> Iterator[Part]:
        for batch in source.batches():
            *first, last = _shared_out(batch.frames)
            for frames in first:
                yield None, embed(frames, jobs)
            yield batch, embed(last, jobs)

    ahead = prefetch(parts(), jobs, _PARTS * _BATCHES_AHEAD)
    yield from _told(ahead, source, progress, verb)


def _shared_out(frames: Sequence[Frame]) -> list[Sequence[Frame]]:
    """Cut images into parts that follow one another; no images are one part."""
    size = max(-(-len(frames) // _PARTS), 1)
    return [frames[begin : begin + size] for begin in range(0, max(len(frames), 1), size)]


def _told(parts: Iterator[P], source: Source, progress: Progress, verb: str) -> Iterator[P]:
    """Yield parts of the replay, and tell of each batch how far the log is."""
    with progress(f"{verb} {source.name}", _seconds(source, source.replay.end_ns)) as report:
        n_observations = 0
        for part in parts:
            yield part
            batch = part[0]
            if batch is not None:
                n_observations += sum(len(block.stamps_ns) for block in batch.scans)
                n_observations += len(batch.frames)
                report(_seconds(source, batch.until_ns), n_observations)


def _seconds(source: Source, stamp_ns: int) -> float:
    return (stamp_ns - source.replay.start_ns) / NS_PER_S
