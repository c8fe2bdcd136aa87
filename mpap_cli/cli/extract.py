"""``mpap extract``."""

from pathlib import Path
from typing import Any

import click

from mpap_cli.cli import options

_FLAGS = {
    "novel": "novel",
    "presses": "press",
    "predicted": "predicted",
    "missed": "missed",
    "false_alarms": "false-alarm",
}


@click.command(
    epilog="""\b
Examples:
  mpap extract day4.bag --novel --keep-ratio 0.1 -o kept
  mpap extract day4.bag --presses --lookback 10 --topics '/scan' --topics '/camera/*'
  mpap extract day4.bag --missed --model mpap-out --dry-run
""",
)
@options.logs(required=True)
@click.option(
    "--novel", is_flag=True, help="What is new to the model; without one to the logs' own past."
)
@click.option("--presses", is_flag=True, help="Presses of the bumper; needs no model.")
@click.option(
    "--predicted",
    type=click.FloatRange(0, 1),
    metavar="P",
    help="Scans with at least that probability of a collision.",
)
@click.option("--missed", is_flag=True, help="Presses that the model does not announce.")
@click.option("--false-alarms", is_flag=True, help="What the model announces and no press follows.")
@click.option(
    "--keep-ratio",
    type=click.FloatRange(0, 1, min_open=True),
    metavar="R",
    help="Keep the most worthwhile until this share of the duration, margins included.",
)
@click.option(
    "--threshold",
    type=click.FloatRange(0, 1),
    metavar="P",
    help="--novel: share of a second (images: half) that must be new; --missed, --false-alarms: "
    "a collision is announced from this probability up (default: 0.2).",
)
@click.option(
    "--lookback",
    type=click.FloatRange(0, 1e6),
    metavar="SECONDS",
    help="Kept before each moment (default: 5; --novel 1, of images 0).",
)
@click.option(
    "--post",
    type=click.FloatRange(0, 1e6),
    metavar="SECONDS",
    help="Kept after each moment (default: 3; --novel 0).",
)
@click.option(
    "--topics",
    multiple=True,
    metavar="TOPIC",
    help="Topics to keep, names or globs (default: all).",
)
@click.option("--split", is_flag=True, help="Write one log for each segment.")
@click.option("--dry-run", is_flag=True, help="List the cuts and their sizes; write nothing.")
@click.option(
    "--model",
    type=click.Path(path_type=Path),
    metavar="MODEL",
    help="Model file or results folder (default: the results folder DIR).",
)
@options.sensor
@options.scan_geometry
@options.settings
@options.out
@options.jobs
@options.table_format
@options.talk
def extract(**words: Any) -> int:
    """Cut the segments worth keeping into new logs, their messages untouched.

    A new log has the container of its log (.bag, MCAP, rosbag2 folder), and its messages
    their bytes and stamps. Latched topics (tf_static, camera_info, robot_description, map,
    transient local or latching ones) are repeated where each segment starts. Segments that
    overlap are one. Writes segments.csv and the logs into DIR/extract.
    """
    from mpap_cli.cli.printing import print_extracted, progress
    from mpap_cli.commands.extract import extract as run
    from mpap_cli.commands.extracting.request import ExtractRequest

    request = ExtractRequest(
        out=words["out"],
        reason=_reason(words),
        model=words["model"],
        threshold=words["predicted"] if words["predicted"] is not None else words["threshold"],
        keep_ratio=words["keep_ratio"],
        lookback_s=words["lookback"],
        post_s=words["post"],
        topics=words["topics"],
        split=words["split"],
        dry_run=words["dry_run"],
        jobs=words["jobs"],
    )
    found = run(options.selection(words), options.request(words), request, progress)
    print_extracted(found, words["shape"])
    return found.exit_code


def _reason(words: dict[str, Any]) -> str:
    """Return the one reason that was given."""
    given = [name for name in _FLAGS if words[name] is not None and words[name] is not False]
    if len(given) != 1:
        found = " and ".join(f"--{name.replace('_', '-')}" for name in given) or "none"
        msg = f"one of --novel, --presses, --predicted P, --missed, --false-alarms; found {found}"
        raise click.UsageError(msg)
    if given == ["predicted"] and words["threshold"] is not None:
        msg = "--predicted P is the threshold; leave out --threshold"
        raise click.UsageError(msg)
    if given == ["presses"] and (words["threshold"] is not None or words["model"] is not None):
        msg = "--presses needs neither --threshold nor --model; leave them out"
        raise click.UsageError(msg)
    return _FLAGS[given[0]]
