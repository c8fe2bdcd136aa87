"""What it costs to ask for help."""

import sys
from pathlib import Path

from benchmarks.measuring.processes import MPAP, children_in_turns
from benchmarks.measuring.table import Row

REPEATS = 11


def startup(_folder: Path) -> list[Row]:
    """Compare ``mpap --help`` and ``--version`` with importing click."""
    commands = [[MPAP, "--help"], [MPAP, "--version"], [sys.executable, "-c", "import click"]]
    asked, version, click = (
        tuple(1000 * one.cpu_s for one in usages) for usages in children_in_turns(commands, REPEATS)
    )
    beside = 'python -c "import click"'
    return [
        Row(
            work=work,
            mpap=figures,
            beside=beside,
            peer=click,
            unit="ms",
            goal="<= 1.5x",
            stretch="<= 1.2x",
        )
        for work, figures in (("mpap --help", asked), ("mpap --version", version))
    ]
