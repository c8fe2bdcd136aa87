"""``mpap novelty``."""

from pathlib import Path
from typing import Any

import click

from mpap_cli.cli import options


@click.command(
    epilog="""\b
Examples:
  mpap novelty A.mcap B.mcap A2.mcap
  mpap novelty day4.bag --model mpap-out --sensor scan
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
    "--model",
    type=click.Path(path_type=Path),
    metavar="MODEL",
    help="Start from what this model file or results folder knows.",
)
@click.option(
    "--window",
    type=click.FloatRange(0, 1e6, min_open=True),
    default=60.0,
    show_default=True,
    metavar="SECONDS",
    help="Length of a window.",
)
@click.option(
    "--step",
    type=click.FloatRange(0, 1e6, min_open=True),
    metavar="SECONDS",
    help="Time between the starts of two windows (default: the window).",
)
@options.out
@options.jobs
@options.table_format
@options.talk
def novelty(**words: Any) -> int:
    """Tell how much of each log is new to a model that is carried from log to log.

    Of every window: the share of observations that the model did not know when they came,
    while it learns on, and the share that it did not know as it stood when the log began.
    Writes novelty.csv and novelty.png into DIR/novelty.
    """
    from mpap_cli.cli.printing import print_novelty, progress
    from mpap_cli.commands.novelty import NoveltyRequest
    from mpap_cli.commands.novelty import novelty as run

    request = NoveltyRequest(
        out=words["out"],
        model=words["model"],
        window_s=words["window"],
        step_s=words["step"],
        jobs=words["jobs"],
    )
    found = run(options.selection(words), options.request(words), request, progress)
    print_novelty(found, words["shape"])
    return found.exit_code
