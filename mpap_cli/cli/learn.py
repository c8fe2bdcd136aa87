"""``mpap learn``."""

from pathlib import Path
from typing import Any

import click

from mpap_cli.cli import options


@click.command(
    epilog="""\b
Examples:
  mpap learn day1.bag day2.bag
  mpap learn day3.mcap --model mpap-out
  mpap learn day1.bag --sensor image
  mpap learn day1.bag --bump-topic '/safety:in_protective_stop'
""",
)
@options.logs(required=True)
@options.sensor
@options.scan_geometry
@options.feature()
@options.settings
@click.option(
    "--model",
    type=click.Path(path_type=Path),
    metavar="MODEL",
    help="Go on from this model file or results folder.",
)
@click.option(
    "--recording/--no-recording",
    default=True,
    show_default=True,
    help="Keep the scans that evaluate reads.",
)
@options.out
@options.jobs
@options.table_format
@options.talk
def learn(**words: Any) -> int:
    """Learn clusters and collision probabilities from logs, one history in the order given.

    Laser scans give a collision model, camera images an appearance model. Writes
    clusters.csv, model.npz, recording.npz, exemplars.png, of images also members.png, and
    settings.json into DIR/learn. Without a bumper there are clusters only.
    """
    from mpap_cli.cli.printing import print_learnt, progress
    from mpap_cli.commands.learn import LearnRequest
    from mpap_cli.commands.learn import learn as run

    request = LearnRequest(
        out=words["out"],
        model=words["model"],
        keep_recording=words["recording"],
        jobs=words["jobs"],
    )
    learnt = run(options.selection(words), options.request(words), request, progress)
    print_learnt(learnt, words["shape"])
    return learnt.exit_code
