"""Results appear whole or not at all.

A command writes into a hidden staging folder beside ``OUT/<command>/``. At the commit
the files are flushed and renamed one by one, and ``settings.json``, which holds the
SHA-256 of each of them, comes last: a set that it does not describe is no result.
A commit that was killed halfway is finished by whoever reads or writes there next.
"""

import errno
import json
import logging
import os
import shutil
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from mpap_cli import __version__
from mpap_cli.errors import OutputError
from mpap_cli.outputs.publishing import clear_staging, flush, lock_of, publish, staging_of
from mpap_cli.outputs.results_record import SETTINGS_NAME, InputFile, is_safe_name, sha256_of

_MOST_WARNINGS = 200
_DISK_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


class _Warnings(logging.Handler):
    """Keeps what was warned of, to stand beside the results."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._texts: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a text once."""
        self._texts.add(record.getMessage())

    def texts(self) -> list[str]:
        """Return at most 200 texts, in an order that threads do not change."""
        return sorted(self._texts)[:_MOST_WARNINGS]


class ResultsFolder:
    r"""Context manager that writes the results of one command into ``OUT/<command>/``.

    Without :meth:`commit` (an error, Ctrl-C) nothing of the old results changes and
    nothing of the new ones stays. A second run on the same folder is named; what a
    killed run left behind is removed.

    Parameters
    ----------
    out : Path
        Folder of all results; made if it is not there.
    command : str
        Name of the command, which is the name of the folder.

    Raises
    ------
    OutputError
        If the folder cannot be written, or another run writes there.

    Examples
    --------
    >>> import tempfile
    >>> out = Path(tempfile.mkdtemp())
    >>> with ResultsFolder(out, "learn") as results:
    ...     _ = results.path("clusters.csv").write_text("cluster\n")
    ...     results.commit({"theta": "0.08"}, inputs=[])
    >>> sorted(path.name for path in (out / "learn").iterdir())
    ['clusters.csv', 'settings.json']
    """

    def __init__(self, out: Path, command: str) -> None:
        self._out = out
        self._command = command
        self.folder = out / command
        self._staging = staging_of(self.folder)
        self._lock = lock_of(self.folder)
        self._made_out = False
        self._warnings = _Warnings()

    def __enter__(self) -> Self:
        try:
            self._made_out = not self._out.exists()
            self._out.mkdir(parents=True, exist_ok=True)
            self._lock.acquire()
            try:
                self._prepare()
            except BaseException:
                self._lock.release()
                raise
        except OSError as err:
            raise self._cannot_write(err) from err
        logging.getLogger("mpap_cli").addHandler(self._warnings)
        return self

    def _prepare(self) -> None:
        """Settle what a dead run left and make the staging folder."""
        clear_staging(self.folder)
        if self.folder.exists():
            next(self.folder.iterdir(), None)
            if not os.access(self.folder, os.W_OK):
                raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        self._staging.mkdir()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        logging.getLogger("mpap_cli").removeHandler(self._warnings)
        try:
            shutil.rmtree(self._staging, ignore_errors=True)
        finally:
            self._lock.release()
        if self._made_out:
            with suppress(OSError):  # not empty: there are results
                self._out.rmdir()
        if isinstance(error, OSError) and error.errno in _DISK_FULL:
            raise self._cannot_write(error) from error

    def _cannot_write(self, error: OSError) -> OutputError:
        found = (error.strerror or str(error)).lower()
        return OutputError(f"{self.folder}: cannot be written ({found}); choose another --out")

    def path(self, name: str) -> Path:
        """Return where to write the output of this name (it may hold folders: ``a/b.png``).

        Raises
        ------
        ValueError
            If the name leads out of the folder or is the one of the settings.
        OutputError
            If the folder of the name cannot be made.
        """
        if not is_safe_name(name) or name == SETTINGS_NAME:
            msg = f"no name for an output: {name}"
            raise ValueError(msg)
        path = self._staging / name
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as err:
            raise self._cannot_write(err) from err
        return path

    def commit(
        self, settings: Mapping[str, Any], inputs: Sequence[InputFile], seed: int = 0
    ) -> None:
        """Put everything written so far in the place of the older results.

        Parameters
        ----------
        settings : mapping
            Settings that can change results, by key; no paths, dates or numbers of jobs.
        inputs : sequence of InputFile
            What was read, in the order given.
        seed : int
            Seed of everything random.

        Raises
        ------
        OutputError
            If the files cannot be put in place.
        """
        try:
            names = self._written()
            record = {
                "mpap": __version__,
                "command": self._command,
                "seed": seed,
                "settings": dict(sorted(settings.items())),
                "inputs": [asdict(item) for item in inputs],
                "warnings": self._warnings.texts(),
                "outputs": {name: sha256_of(self._staging / name) for name in names},
            }
            text = json.dumps(record, indent=2, allow_nan=False) + "\n"
            (self._staging / SETTINGS_NAME).write_text(text, encoding="utf-8")
            for name in (*names, SETTINGS_NAME):
                flush(self._staging / name)
            try:
                publish(self.folder)
            except KeyboardInterrupt:
                # half of the renames would leave neither the old results nor the new
                publish(self.folder)
                raise
        except OSError as err:
            raise self._cannot_write(err) from err

    def _written(self) -> list[str]:
        """List the outputs in the staging folder."""
        paths = (path for path in self._staging.rglob("*") if path.is_file())
        return sorted(path.relative_to(self._staging).as_posix() for path in paths)
