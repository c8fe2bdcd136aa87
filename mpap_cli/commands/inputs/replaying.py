"""Logs on their way through a command: read ahead in a thread, with progress."""

from collections.abc import Callable, Iterator, Sequence

from mpap_cli.commands.inputs.progress import Progress
from mpap_cli.commands.inputs.sources import Source
from mpap_cli.observations import NS_PER_S, Batch, Frame, PatchBlock
from mpap_cli.systems.stream import prefetch

Embed = Callable[[Sequence[Frame]], PatchBlock]
Step = tuple[Batch, PatchBlock | None]


def follow(
    source: Source, jobs: int, progress: Progress, verb: str, embed: Embed | None = None
) -> Iterator[Step]:
    """Replay a log, and tell how far it is.

    Parameters
    ----------
    source : Source
        An opened log.
    jobs : int
        2 or more: reading, decoding and image features run in a thread of their own.
    progress : Progress
        Told after every batch.
    verb : str
        What is done with the log, such as learn.
    embed : callable, optional
        Turns the frames of a batch into patches, in the thread that reads.

    Yields
    ------
    tuple of Batch and PatchBlock
        The patches are None without ``embed``.
    """

    def steps() -> Iterator[Step]:
        for batch in source.batches():
            yield batch, None if embed is None else embed(batch.frames)

    with progress(f"{verb} {source.name}", _seconds(source, source.replay.end_ns)) as report:
        n_observations = 0
        for batch, patches in prefetch(steps(), jobs):
            yield batch, patches
            n_observations += sum(len(block.stamps_ns) for block in batch.scans)
            n_observations += len(batch.frames)
            report(_seconds(source, batch.until_ns), n_observations)


def _seconds(source: Source, stamp_ns: int) -> float:
    return (stamp_ns - source.replay.start_ns) / NS_PER_S
