"""``mpap merge``."""

from pathlib import Path
from typing import Any

import click

from mpap_cli.cli import options


@click.command(
    epilog="""\b
Example:
  mpap merge monday/ tuesday/ -o week
""",
)
@click.argument(
    "models",
    nargs=-1,
    required=True,
    type=click.Path(path_type=Path),
    metavar="MODEL...",
)
@options.out
@options.table_format
@options.talk
def merge(**words: Any) -> int:
    """Make one model of several that were learnt with the same settings.

    The order of the models does not matter. Writes model.npz and clusters.csv into DIR/merge.
    """
    from mpap_cli.cli.printing import print_learnt
    from mpap_cli.commands.merge import merge as run

    merged = run(words["models"], out=words["out"])
    print_learnt(merged, words["shape"])
    return merged.exit_code
