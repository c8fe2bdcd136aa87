"""Segments cut out of their logs, byte by byte, into logs of the same container."""

import re
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Annotated

from mpap_cli.commands.extracting.request import ExtractRequest, Found, FoundLog
from mpap_cli.commands.inputs.progress import Progress
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.keeping import Moment, by_log
from mpap_cli.logs.passthrough.cuts import Cut, cut_records
from mpap_cli.logs.passthrough.reader import PassthroughLog, chosen_channels
from mpap_cli.logs.reader import Damage
from mpap_cli.logs.writing.raw_log import SUFFIXES, RawLogWriter
from mpap_cli.observations import NS_PER_S
from mpap_cli.outputs.file_names import file_name
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.systems.columns import Cluster, LogIndex, LogName

_ENDINGS = re.compile(r"(\.(bag|active|mcap|db3|zstd|zst))+$")
_MOST_NAMED = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentRow:
    """One segment (a row of segments.csv)."""

    log: LogName
    log_index: LogIndex
    start_s: Annotated[float, "begin in seconds since the first message of the log"]
    end_s: Annotated[float, "end, behind the last moment"]
    reason: Annotated[str, "`novel`, `press`, `predicted`, `missed` or `false-alarm`"]
    score: Annotated[
        float,
        "worth: novel: share of all that is new which it adds; press: seconds pressed; "
        "predicted, false-alarm: highest probability; missed: 1 less the probability",
    ]
    cluster: Cluster
    messages: Annotated[int, "messages that the new log holds of it, repeated ones too"]
    bytes: Annotated[int, "their size"]


@dataclass(slots=True)
class CutLogs:
    """What was cut: rows, names of the new logs, and the damage that was met on the way."""

    rows: list[SegmentRow]
    names: list[str]
    damage: list[Damage]


def cut_logs(
    found: Found,
    request: ExtractRequest,
    results: ResultsFolder,
    progress: Progress,
    *,
    strict: bool,
) -> CutLogs:
    """Cut the segments out of every log that has any.

    Parameters
    ----------
    found : Found
        Logs and segments.
    request : ExtractRequest
        Topics; one log or one a segment; whether anything is written.
    results : ResultsFolder
        Where the new logs go.
    progress : Progress
        Told how far each log is.
    strict : bool
        Damage is an error.

    Raises
    ------
    UsageError
        If no log has a topic that was asked for.
    OutputError
        If a log cannot be written.
    """
    cut = CutLogs([], [], [])
    unknown: set[str] = set()
    matched = not request.topics
    for index, segments in by_log(found.segments):
        log = found.logs[index]
        with PassthroughLog(log.path, strict=strict) as source:
            chosen = chosen_channels(source.channels, request.topics)
            unknown.update(channel.topic for channel in source.channels)
            if chosen:
                matched = True
                _Cutter(log, index, request, results).cut(source, chosen, segments, cut, progress)
            cut.damage.extend(source.damage)
    if not matched and found.segments:
        names = ", ".join(sorted(unknown)[:_MOST_NAMED])
        msg = f"--topics {' '.join(request.topics)}: matches no topic; there are {names}"
        raise UsageError(msg)
    return cut


class _Cutter:
    """Cuts one log."""

    def __init__(
        self, log: FoundLog, index: int, request: ExtractRequest, results: ResultsFolder
    ) -> None:
        self._log = log
        self._index = index
        self._request = request
        self._results = results

    def cut(
        self,
        source: PassthroughLog,
        chosen: Sequence[int],
        segments: Sequence[Moment],
        cut: CutLogs,
        progress: Progress,
    ) -> None:
        """Write the segments, into one log or one each, and their rows."""
        groups = [[one] for one in segments] if self._request.split else [list(segments)]
        total_s = sum(one.length_ns for one in segments) / NS_PER_S
        with progress(f"cut {self._log.name}", total_s) as report:
            n_messages, done_s = 0, 0.0
            for number, group in enumerate(groups, 1):
                name = self._name(source, number)
                for row in self._write(source, chosen, group, name):
                    n_messages += row.messages
                    done_s += row.end_s - row.start_s
                    report(done_s, n_messages)
                    cut.rows.append(row)
                cut.names.append(name)

    def _write(
        self, source: PassthroughLog, chosen: Sequence[int], segments: Sequence[Moment], name: str
    ) -> list[SegmentRow]:
        """Write one log; return what is in it."""
        totals = [[0, 0] for _ in segments]
        cuts = [Cut(one.start_ns, one.end_ns) for one in segments]
        with self._writer(source, chosen, name) as writer:
            for number, record in cut_records(source, chosen, cuts):
                totals[number][0] += 1
                totals[number][1] += len(record.payload)
                if writer is not None:
                    writer.write(record)
        return [self._row(one, *total) for one, total in zip(segments, totals, strict=True)]

    def _writer(
        self, source: PassthroughLog, chosen: Sequence[int], name: str
    ) -> AbstractContextManager[RawLogWriter | None]:
        """Open the new log; None where nothing is to be written."""
        if self._request.dry_run:
            return nullcontext(None)
        channels = {number: source.channels[number] for number in chosen}
        return RawLogWriter(self._results.path(name), source.origin, channels)

    def _row(self, segment: Moment, messages: int, n_bytes: int) -> SegmentRow:
        return SegmentRow(
            log=self._log.name,
            log_index=self._index,
            start_s=(segment.start_ns - self._log.start_ns) / NS_PER_S,
            end_s=(segment.end_ns - self._log.start_ns) / NS_PER_S,
            reason=self._request.reason,
            score=segment.score,
            cluster=segment.cluster,
            messages=messages,
            bytes=n_bytes,
        )

    def _name(self, source: PassthroughLog, number: int) -> str:
        """Name a new log after its origin; with its number where there are several."""
        part = f"-{number:03d}" if self._request.split else ""
        ending = f"{part}{SUFFIXES.get(source.origin.container, '')}"
        return file_name(f"{self._index}-{_ENDINGS.sub('', self._log.name)}", ending)
