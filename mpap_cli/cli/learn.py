"""``mpap learn``."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpap_cli.cli import options

if TYPE_CHECKING:
    from mpap_cli.commands.learning.summary import Learnt


@click.command(
    epilog="""\b
Examples:
  mpap learn day1.bag day2.bag
  mpap learn day3.mcap --model mpap-out
  mpap learn day1.bag --sensor image
  mpap learn day1.bag --bump-topic '/safety:in_protective_stop'
  mpap learn --merge 'fleet/*/*.mcap' --jobs 8
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
@click.option(
    "--merge",
    is_flag=True,
    help="One model per log in --jobs N processes, merged into one; laser scans only.",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="With --merge: the workers of this Dask scheduler, such as tcp://host:8786.",
)
@options.out
@options.jobs
@options.table_format
@options.talk
def learn(**words: Any) -> int:
    """Learn clusters and collision probabilities from logs, one history in the order given.

    Laser scans give a collision model, camera images an appearance model. Writes
    clusters.csv, model.npz, recording.npz, exemplars.png, of images also members.png, and
    settings.json into DIR/learn. Without a bumper there are clusters only. With --merge the
    order does not matter; DIR/leaves keeps what was learnt of each log, and manifest.csv.
    """
    from mpap_cli.cli.printing import print_learnt, progress

    if words["merge"] or words["scheduler"]:
        learnt = _learn_merged(words)
        print_learnt(learnt, words["shape"])
        return learnt.exit_code
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


def _learn_merged(words: dict[str, Any]) -> "Learnt":
    """Learn each log apart and merge; options that need one history are refused."""
    from mpap_cli.commands.fleet.learn_merged import MergeRequest, learn_merged
    from mpap_cli.errors import UsageError

    if not words["merge"]:
        msg = "--scheduler gives work to many machines, one log each; add --merge"
        raise UsageError(msg)
    if words["model"] is not None:
        msg = "--merge learns every log anew; leave out --model, and merge with 'mpap merge'"
        raise UsageError(msg)
    request = MergeRequest(
        out=words["out"],
        keep_recording=words["recording"],
        jobs=words["jobs"],
        scheduler=words["scheduler"],
    )
    return learn_merged(options.selection(words), options.request(words), request)
