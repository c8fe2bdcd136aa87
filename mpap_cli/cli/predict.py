"""``mpap predict``."""

from pathlib import Path
from typing import Any

import click

from mpap_cli.cli import options


@click.command(
    epilog="""\b
Example:
  mpap predict mpap-out day4.bag
""",
)
@click.argument("model", type=click.Path(path_type=Path))
@options.logs(required=True)
@options.threshold
@options.out
@options.jobs
@options.table_format
@options.talk
def predict(**words: Any) -> int:
    """Predict the probability of a collision for every scan of the logs.

    MODEL is a model file or a results folder. Writes timeline.csv, presses.csv and
    timeline.png into DIR/predict.
    """
    from mpap_cli.cli.printing import print_predicted, progress
    from mpap_cli.commands.predict import PredictRequest
    from mpap_cli.commands.predict import predict as run

    request = PredictRequest(
        out=words["out"],
        model=words["model"],
        threshold=words["threshold"],
        jobs=words["jobs"],
    )
    predicted = run(options.selection(words), request, progress)
    print_predicted(predicted, words["shape"])
    return predicted.exit_code
