"""``mpap compare``."""

from typing import Any

import click

from mpap_cli.cli import options


@click.command(
    epilog="""\b
Examples:
  mpap compare monday.mcap tuesday.mcap wednesday.mcap
  mpap compare known/*.bag today.bag --fail-if-novel 0.2
""",
)
@options.logs(required=True)
@click.option(
    "--sensor",
    type=click.Choice(["auto", "image", "scan"]),
    default="auto",
    show_default=True,
    help="Images if every log has them, else scans.",
)
@options.scan_geometry
@options.settings
@click.option(
    "--fail-if-novel",
    type=click.FloatRange(0, 1),
    metavar="SHARE",
    help="End with exit code 4 if more of the last log is unknown to all others together.",
)
@options.out
@options.jobs
@options.table_format
@options.talk
def compare(**words: Any) -> int:
    """Tell how much of each log the others explain.

    Each log is learnt alone; then every observation of each log is held against what was
    learnt of the others, one by one and all together. Writes compare.csv and compare.png into
    DIR/compare.
    """
    from mpap_cli.cli.printing import print_compared, progress
    from mpap_cli.commands.compare import CompareRequest
    from mpap_cli.commands.compare import compare as run

    request = CompareRequest(
        out=words["out"], fail_if_novel=words["fail_if_novel"], jobs=words["jobs"]
    )
    found = run(options.selection(words), options.request(words), request, progress)
    print_compared(found, words["shape"])
    return found.exit_code
