"""What is read of logs goes into a recording, for those who score it later."""

from pathlib import Path
from types import TracebackType
from typing import Self

from mpap_cli.commands.inputs.sources import Source
from mpap_cli.errors import UsageError
from mpap_cli.observations import Batch, Press
from mpap_cli.outputs.recorded_log import RecordedLog
from mpap_cli.outputs.recording import RecordingWriter


class Recorder:
    """Context manager that writes the scans and presses of logs into a recording.

    Attributes
    ----------
    headings_assumed : list of int
        Indices of logs whose forward direction is an assumption.
    n_scans : int
        Scans so far, over all logs.
    scan_span : tuple of int or None
        First and last stamp of the scans of the log that is replayed; None without scans.
    """

    def __init__(self, path: Path) -> None:
        self._writer = RecordingWriter(path)
        self.n_scans = 0
        self.headings_assumed: list[int] = []
        self.scan_span: tuple[int, int] | None = None

    def __enter__(self) -> Self:
        self._writer.__enter__()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._writer.__exit__(kind, error, trace)

    def begin_log(self) -> None:
        """Start with the next log."""
        self.scan_span = None

    def record(self, batch: Batch) -> None:
        """Keep the scans of a batch."""
        for block in batch.scans:
            self._writer.add_block(block)
            self.n_scans += len(block.stamps_ns)
            first_ns = self.scan_span[0] if self.scan_span else int(block.stamps_ns[0])
            self.scan_span = first_ns, int(block.stamps_ns[-1])

    def require_scans(self) -> None:
        """Refuse to go on where no scan was read at all.

        Raises
        ------
        UsageError
            If there was none.
        """
        if self.n_scans == 0:
            msg = "no scan was read from the logs; check --start, --end and --scan-topic"
            raise UsageError(msg)

    def end_log(self, source: Source, presses: tuple[Press, ...] | None) -> None:
        """Write what is known of the log that has been replayed."""
        if source.survey.forward_source == "assumed":
            self.headings_assumed.append(source.index)
        self._writer.end_log(
            RecordedLog(
                name=source.name,
                path=str(source.path.absolute()),
                start_ns=source.start.start_ns,
                end_ns=source.replay.end_ns,
                forward_rad=source.start.forward_rad,
                range_max=source.start.range_max,
                presses=presses,
                bump_source=source.start.bump_source,
            )
        )
