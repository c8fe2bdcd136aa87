"""``mpap evaluate``."""

from pathlib import Path
from typing import Any

import click

from mpap_cli.cli import options

# a copy, so that --help need not import numpy
PROTOCOLS = ("blocked", "leave-one-log-out", "leave-one-group-out", "in-sample", "prequential")


@click.command(
    epilog="""\b
Examples:
  mpap evaluate
  mpap evaluate --feature global-diff --bins 6
  mpap evaluate 'logs/*.bag' --groups folder --target early:1
  mpap evaluate --sweep theta=0.05,0.1,0.2
""",
)
@options.logs(required=False)
@options.scan_geometry
@options.feature("all")
@options.settings
@click.option(
    "--model",
    type=click.Path(path_type=Path),
    metavar="MODEL",
    help="Score this model on the logs instead of training.",
)
@click.option("--protocol", type=click.Choice(PROTOCOLS), help="Default: what the logs allow.")
@click.option(
    "--groups",
    metavar="folder|REGEX|FILE.csv",
    help="Logs that belong together, for leave-one-group-out.",
)
@click.option(
    "--target",
    default="contact",
    show_default=True,
    metavar="contact|onset|early:S",
    help="What is scored: pressed, just pressed, a press within S seconds.",
)
@click.option("--truth", type=options.FILE, metavar="FILE.csv", help="Edited presses.csv.")
@click.option("--sweep", metavar="KEY=V1,V2,...", help="One line for every value of a setting.")
@options.threshold
@options.out
@options.jobs
@options.table_format
@options.talk
def evaluate(**words: Any) -> int:
    """Score collision prediction: ROC, AUC, lead times, false alarms, with baselines beside it.

    Without LOG it scores what was learnt last in DIR. --feature and --bins select profile
    paper. Writes auc.csv, differences.csv (from every other method, over the same logs),
    roc.csv, operating.csv (what each threshold announces), timeline.csv, presses.csv,
    clusters.csv and three plots into DIR/evaluate.
    """
    from mpap_cli.cli.printing import print_evaluated, progress
    from mpap_cli.commands.evaluate import EvaluateRequest
    from mpap_cli.commands.evaluate import evaluate as run

    request = EvaluateRequest(
        out=words["out"],
        protocol=words["protocol"],
        groups=words["groups"],
        target=words["target"],
        truth=words["truth"],
        sweep=words["sweep"],
        threshold=words["threshold"],
        model=words["model"],
        jobs=words["jobs"],
    )
    evaluated = run(options.selection(words), options.request(words), request, progress)
    print_evaluated(evaluated, words["shape"])
    return evaluated.exit_code
