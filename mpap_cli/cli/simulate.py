"""``mpap simulate``."""

from pathlib import Path
from typing import Any

import click

from mpap_cli.cli import options

# copies, so that --help need not import numpy
CONTAINERS = ("bag", "rosbag2-sqlite3", "rosbag2-mcap", "mcap", "mcap-ros1", "mcap-json")
WORLDS = ("indoor", "outdoor")


@click.command(
    epilog="""\b
Examples:
  mpap simulate run1.bag --world indoor --duration 120 --seed 1
  mpap simulate run2.mcap --world outdoor --bumper create3
""",
)
@click.argument("log", type=click.Path(path_type=Path))
@click.option(
    "--world",
    type=click.Choice(WORLDS),
    default="indoor",
    show_default=True,
    help="What the robot drives through.",
)
@click.option(
    "--duration",
    type=float,
    default=300.0,
    show_default=True,
    metavar="SECONDS",
    help="Length of the log.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Of everything that happens.")
@click.option("--world-seed", type=int, help="Of the world; logs of one world share it.")
@click.option(
    "--container",
    type=click.Choice(CONTAINERS),
    help="Default: by the ending of LOG (.bag, .mcap, else a rosbag2 folder).",
)
@click.option("--compression", metavar="NAME", help="Such as zstd, lz4, none.")
@click.option("--bumper", metavar="NAME", help="Bumper type, such as kobuki or bool.")
@click.option(
    "--forward",
    "forward_deg",
    type=float,
    default=0.0,
    show_default=True,
    metavar="DEG",
    help="Direction of travel in the frame of the scanner.",
)
@click.option(
    "--no-return",
    default="above-max",
    show_default=True,
    metavar="CODE",
    help="What a beam without return reads: above-max, zero or inf.",
)
@options.talk
def simulate(**words: Any) -> None:
    """Write the log of a simulated robot with laser, bumper and odometry, and the truth.

    The truth goes into LOG.truth.csv: every contact, also those that the bumper missed or
    the laser cannot see. It can be given to evaluate as --truth.
    """
    from mpap_cli.commands.simulate import container_for
    from mpap_cli.commands.simulate import simulate as run

    log = words.pop("log")
    container = words.pop("container") or container_for(log)
    written = run(log, container=container, duration_s=words.pop("duration"), **words)
    click.echo(
        f"{written.path}: {written.n_scans} scans, {len(written.contacts)} contacts; "
        f"truth: {written.truth_path}"
    )
