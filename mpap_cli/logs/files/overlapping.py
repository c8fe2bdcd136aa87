"""Which files of a log have to be read together."""

from collections.abc import Iterator, Sequence
from operator import attrgetter

from mpap_cli.logs.raw import LogFile


def overlapping(
    files: Sequence[LogFile], start_ns: int | None, end_ns: int | None
) -> Iterator[list[LogFile]]:
    """Yield the files of that time, those together that overlap, so that few are open."""
    group: list[LogFile] = []
    group_end = 0
    for file in sorted(files, key=attrgetter("start_ns")):
        late = end_ns is not None and file.start_ns >= end_ns
        if late or not file.n_messages or (start_ns is not None and file.end_ns < start_ns):
            continue
        if group and file.start_ns > group_end:
            yield group
            group = []
        group_end = max(file.end_ns, group_end) if group else file.end_ns
        group.append(file)
    if group:
        yield group
