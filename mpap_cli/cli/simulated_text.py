"""What ``mpap simulate`` prints: one sentence, or one row for programs."""

import sys
from dataclasses import dataclass
from typing import Annotated

from mpap_cli.outputs import console
from mpap_cli.outputs.text_table import printable
from mpap_cli.simulation.scenario import SimulatedLog


@dataclass(frozen=True, slots=True)
class SimulatedRow:
    """What ``simulate --format csv`` prints, and json."""

    path: Annotated[str, "the log"]
    scans: Annotated[int, "scans in it"]
    images: Annotated[int | None, "images in it; empty without a camera"]
    contacts: Annotated[int, "contacts, also those that the bumper missed"]
    messages: Annotated[int, "messages in it"]
    truth: Annotated[str, "table of the contacts"]


def print_simulated(written: SimulatedLog, shape: str, *, camera: bool) -> None:
    """Print what was written."""
    row = SimulatedRow(
        path=str(written.path),
        scans=written.n_scans,
        images=written.n_images if camera else None,
        contacts=len(written.contacts),
        messages=written.n_messages,
        truth=str(written.truth_path),
    )
    if shape != "table":
        console.print_rows(SimulatedRow, [row], shape, sys.stdout)
        return
    images = f"{row.images} images, " if camera else ""
    text = f"{row.path}: {row.scans} scans, {images}{row.contacts} contacts; truth: {row.truth}"
    sys.stdout.write(f"{printable(text)}\n")
