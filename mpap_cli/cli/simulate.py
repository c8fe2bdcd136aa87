"""``mpap simulate``."""

from pathlib import Path
from typing import Any

import click

from mpap_cli.cli import options

# copies, so that --help need not import numpy
CONTAINERS = ("bag", "rosbag2-sqlite3", "rosbag2-mcap", "mcap", "mcap-ros1", "mcap-json")
WORLDS = ("indoor", "outdoor")
ENCODINGS = ("jpeg", "png", "rgb8", "bgr8", "mono8", "bayer_rggb8")
TEXTURES = ("a", "b", "c")
LIGHTS = ("day", "evening", "dusk")


@click.command(
    epilog="""\b
Examples:
  mpap simulate run1.bag --world indoor --duration 120 --seed 1
  mpap simulate run2.mcap --world outdoor --bumper create3
  mpap simulate run3.mcap --camera --textures b --light evening
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
@click.option(
    "--camera/--no-camera",
    default=False,
    show_default=True,
    help="Whether the robot has a camera; the following options need it.",
)
@click.option("--camera-hz", type=float, metavar="HZ", help="Images a second (default 5).")
@click.option("--image-encoding", type=click.Choice(ENCODINGS), help="Default: jpeg.")
@click.option("--image-size", metavar="WxH", help="In pixels (default 640x480).")
@click.option(
    "--textures",
    type=click.Choice(TEXTURES),
    help="Surfaces of floors, walls and things (default a); no two sets share a kind.",
)
@click.option(
    "--light",
    type=click.Choice(LIGHTS),
    help="Light, and the settings of the camera in it (default day).",
)
@options.table_format
@options.talk
def simulate(**words: Any) -> None:
    """Write the log of a simulated robot with laser, bumper, odometry, camera, and the truth.

    The truth goes into LOG.truth.csv: every contact, also those that the bumper missed or
    the laser cannot see. It can be given to evaluate as --truth. With --camera there are
    LOG.patches.csv (how much floor, wall and obstacle each patch of an image shows) and
    LOG.images.csv (how far the way ahead is free).
    """
    from mpap_cli.cli.simulated_text import print_simulated
    from mpap_cli.commands.simulate import container_for
    from mpap_cli.commands.simulate import simulate as run

    log, shape = words.pop("log"), words.pop("shape")
    container = words.pop("container") or container_for(log)
    camera = _camera(words)
    written = run(
        log, camera=camera, container=container, duration_s=words.pop("duration"), **words
    )
    print_simulated(written, shape, camera=camera is not None)


def _camera(words: dict[str, Any]) -> dict[str, Any] | None:
    """Take the camera's settings out of the words; None where there is no camera."""
    fields = {
        "camera_hz": "hz",
        "image_encoding": "encoding",
        "image_size": "size",
        "textures": "textures",
        "light": "light",
    }
    given = {word: words.pop(word) for word in fields}
    given = {word: value for word, value in given.items() if value is not None}
    if words.pop("camera"):
        return {fields[word]: value for word, value in given.items()}
    for word in given:
        msg = f"--{word.replace('_', '-')} needs --camera"
        raise click.UsageError(msg)
    return None
