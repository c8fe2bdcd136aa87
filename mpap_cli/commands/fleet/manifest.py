"""The manifest of a fleet: one row a log with its state, for people and for schedulers."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

from mpap_cli.commands.fleet.identity import Sighting
from mpap_cli.commands.fleet.tasks import Leaf
from mpap_cli.outputs.model_file import MODEL_NAME
from mpap_cli.outputs.results_reader import InputFile
from mpap_cli.outputs.tables import write_csv
from mpap_cli.systems.columns import LogName

MANIFEST = "manifest.csv"
DONE, FAILED, PENDING = "done", "failed", "pending"


@dataclass(frozen=True, slots=True)
class ManifestRow:
    """A row of manifest.csv.

    ``path``, ``bytes`` and ``changed`` tell whether the content is still that of ``sha256``.
    """

    log: LogName
    state: Annotated[str, "`done`, `failed` or `pending`"]
    reason: Annotated[str, "why it failed, or what is to be known"]
    scans: Annotated[int | None, "scans of the log"]
    presses: Annotated[int | None, "presses of the log; empty without a bumper"]
    seconds: Annotated[float | None, "that learning took, in whichever run"]
    leaf: Annotated[str, "model file, from the folder of the manifest"]
    path: Annotated[str, "where the log lay"]
    bytes: Annotated[int | None, "its size"]
    changed: Annotated[str, "time of its last change"]
    sha256: Annotated[str, "checksum of its content"]


class Manifest:
    """The rows of one run, written anew whenever one of them changes.

    Parameters
    ----------
    folder : Path
        The folder of the leaves.
    names : sequence of str
        Base names of the logs.
    seen : sequence of Sighting or None
        What is known of each without reading it; None if it cannot be reached.
    """

    def __init__(self, folder: Path, names: Sequence[str], seen: Sequence[Sighting | None]) -> None:
        self._path = folder / MANIFEST
        self._digests = _read_digests(self._path)
        self._rows = [self._pending(name, one) for name, one in zip(names, seen, strict=True)]
        self.write()

    def known(self, number: int, seen: Sighting | None) -> InputFile | None:
        """Return what an earlier run read of a log that has not changed since."""
        digest = self._digests.get(seen) if seen is not None else None
        if seen is None or not digest:
            return None
        return InputFile(self._rows[number].log, seen.size, digest)

    def done(self, number: int, leaf: Leaf, reason: str = "") -> None:
        """Note a leaf."""
        facts = leaf.facts
        self._rows[number] = replace(
            self._rows[number],
            state=DONE,
            reason=reason or ("part of it is damaged" if facts.damaged else ""),
            scans=facts.n_scans,
            presses=facts.n_presses,
            seconds=facts.seconds,
            leaf=f"{leaf.folder.name}/{MODEL_NAME}",
            sha256=leaf.log.sha256,
        )
        self.write()

    def missing(self, number: int, state: str, reason: str) -> None:
        """Note why there is no leaf: the log failed, or was not learnt yet."""
        self._rows[number] = replace(self._rows[number], state=state, reason=reason)
        self.write()

    def write(self) -> None:
        """Put the rows in the place of the older ones."""
        beside = self._path.with_name(f".{MANIFEST}.unfinished")
        beside.unlink(missing_ok=True)  # of a killed run, or a link that leads elsewhere
        try:
            write_csv(beside, ManifestRow, self._rows)
            beside.replace(self._path)
        except BaseException:
            beside.unlink(missing_ok=True)
            raise

    def _pending(self, name: str, seen: Sighting | None) -> ManifestRow:
        """Return the row of a log that waits; what is known of its content stays."""
        path, size, changed = (seen.path, seen.size, seen.changed) if seen else ("", None, "")
        digest = self._digests.get(seen, "") if seen else ""
        return ManifestRow(name, PENDING, "", None, None, None, "", path, size, changed, digest)


def _read_digests(path: Path) -> dict[Sighting, str]:
    """Return the SHA-256 of every log that the manifest of an earlier run knows."""
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            return {
                Sighting(row["path"], int(row["bytes"]), row["changed"]): row["sha256"]
                for row in csv.DictReader(stream)
                if row["sha256"]
            }
    except (OSError, ValueError, KeyError, TypeError, csv.Error):
        return {}  # all logs are read again
