"""A log on its way through a command: whole batches, or their patches in parts."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from mpap_cli.commands.inputs.progress import Report, no_progress
from mpap_cli.commands.inputs.replaying import follow, follow_in_parts
from mpap_cli.commands.inputs.sources import Source
from mpap_cli.observations import NS_PER_S, Batch, Frame, PatchBlock

SIZES = [0, 1, 7, 8, 9, 100]


def source_of(sizes: Sequence[int]) -> Source:
    """Return a log with one batch a second, of so many images."""
    batches = [
        Batch(second * NS_PER_S, (), (), tuple(Frame(n, "bgr8", 1, 1, 3, b"") for n in range(size)))
        for second, size in enumerate(sizes, 1)
    ]
    replay = SimpleNamespace(start_ns=0, end_ns=len(sizes) * NS_PER_S)
    log = SimpleNamespace(name="a.mcap", replay=replay, batches=lambda: iter(batches))
    return cast("Source", log)


def embed(frames: Sequence[Frame], jobs: int) -> PatchBlock:
    """Return a block that holds the stamps alone."""
    assert jobs in (1, 2)
    stamps_ns = np.array([frame.stamp_ns for frame in frames], np.int64)
    return PatchBlock(stamps_ns, np.empty((len(frames), 1, 1), np.float32), stamps_ns)


@pytest.mark.parametrize("jobs", [1, 2])
def test_the_parts_of_a_batch_are_its_patches_in_order(jobs: int) -> None:
    """The batch comes with the last of at most eight parts, however few images it has."""
    batches: list[Batch] = []
    waiting: list[int] = []
    n_parts = [0]

    for batch, patches in follow_in_parts(source_of(SIZES), jobs, no_progress, "learn", embed):
        assert patches is not None
        n_parts[-1] += 1
        waiting += patches.stamps_ns.tolist()
        if batch is not None:
            assert waiting == [frame.stamp_ns for frame in batch.frames]
            batches.append(batch)
            waiting.clear()
            n_parts.append(0)

    assert [len(batch.frames) for batch in batches] == SIZES
    assert n_parts == [1, 1, 7, 8, 5, 8, 0]


@pytest.mark.parametrize("in_parts", [False, True])
def test_progress_is_told_once_a_batch(in_parts: bool) -> None:
    """It counts images and seconds of log, whether patches come in parts or not."""
    told: list[tuple[float, int]] = []

    @contextmanager
    def progress(title: str, total_s: float | None) -> Iterator[Report]:
        assert (title, total_s) == ("learn a.mcap", 2.0)
        yield lambda done_s, n_observations: told.append((done_s, n_observations))

    source = source_of([3, 20])
    replay = follow_in_parts if in_parts else follow
    n_yielded = sum(1 for _ in replay(source, 1, progress, "learn", embed))

    assert told == [(1.0, 3), (2.0, 23)]
    assert n_yielded == (3 + 7 if in_parts else 2)


def test_without_images_to_embed_there_are_no_patches() -> None:
    """Commands that read scans alone ask for none."""
    patches = [block for _, block in follow(source_of([2, 2]), 2, no_progress, "read")]

    assert patches == [None, None]
