"""``mpap predict``."""

from pathlib import Path
from typing import Any

import click

from mpap_cli.cli import options


@click.command(
    epilog="""\b
Examples:
  mpap predict mpap-out day4.bag
  mpap predict mpap-out day4.bag --to-mcap
""",
)
@click.argument("model", type=click.Path(path_type=Path))
@options.logs(required=True)
@options.sensor
@options.threshold
@click.option(
    "--patch-threshold",
    type=click.FloatRange(0, 1),
    metavar="P",
    help="A patch of an image is an obstacle from this probability up (default: as learnt).",
)
@click.option(
    "--to-mcap",
    is_flag=True,
    help="Also write the predictions as a log, to be opened beside the original.",
)
@options.out
@options.jobs
@options.table_format
@options.talk
def predict(**words: Any) -> int:
    """Predict collisions for every scan of the logs, and obstacles and motion for every image.

    MODEL is a model file or a results folder. Writes into DIR/predict: of scans timeline.csv,
    presses.csv and timeline.png; of images decisions.csv, patches.csv and annotated.png.
    """
    from mpap_cli.cli.printing import print_predicted, progress
    from mpap_cli.commands.predict import predict as run
    from mpap_cli.commands.predicting.request import PredictRequest

    request = PredictRequest(
        out=words["out"],
        model=words["model"],
        threshold=words["threshold"],
        patch_threshold=words["patch_threshold"],
        to_mcap=words["to_mcap"],
        jobs=words["jobs"],
    )
    predicted = run(options.selection(words), request, progress)
    print_predicted(predicted, words["shape"])
    return predicted.exit_code
