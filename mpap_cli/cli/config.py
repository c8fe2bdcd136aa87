"""``mpap config``."""

from typing import Any

import click

from mpap_cli.cli import options


@click.command(
    epilog="""\b
Examples:
  mpap config
  mpap config --profile paper --set theta=0.2
""",
)
@options.feature()
@options.settings
@options.table_format
@options.talk
def config(**words: Any) -> None:
    """List every setting with its value, where that comes from, and its section in the paper.

    A setting is changed by --set KEY=VALUE or in a TOML file of KEY = VALUE lines (--config).
    """
    from mpap_cli.cli.printing import print_rows
    from mpap_cli.commands.settings import config as run

    print_rows(run(options.request(words)), words["shape"])
