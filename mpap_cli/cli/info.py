"""``mpap info``."""

from typing import Any

import click

from mpap_cli.cli import options


@click.command(
    epilog="""\b
Examples:
  mpap info day1.bag
  mpap info 'logs/*.mcap' --format json
  mpap info mpap-out
""",
)
@options.logs(required=True)
@options.table_format
@options.talk
def info(**words: Any) -> int:
    """Show what a log holds, which topics would be used and why, and what could be learnt.

    LOG may also be a model file or results folder: then what it knows, and from which logs.
    """
    from mpap_cli.cli.printing import print_infos, progress
    from mpap_cli.commands.info import info as run

    infos = run(options.selection(words), progress)
    print_infos(infos, words["shape"])
    return infos.exit_code
