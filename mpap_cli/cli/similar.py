"""``mpap similar``."""

from pathlib import Path
from typing import Any

import click

from mpap_cli.cli import options


@click.command(
    epilog="""\b
Examples:
  mpap similar mpap-out --at day4.bag@12.5
  mpap similar mpap-out --at day4.bag@1:30 --sensor image --count 3
""",
)
@click.argument("model", type=click.Path(path_type=Path))
@click.option("--at", required=True, metavar="LOG@TIME", help="The moment, such as day4.bag@12.5.")
@click.option(
    "--sensor",
    type=click.Choice(["auto", "scan", "image"]),
    default="auto",
    show_default=True,
    help="Laser scan or camera image of that moment; scans come first.",
)
@click.option(
    "--count",
    type=click.IntRange(1, 1000),
    default=10,
    show_default=True,
    metavar="N",
    help="Most moments shown.",
)
@click.option(
    "--apart",
    type=click.FloatRange(0, 1e6),
    default=5.0,
    show_default=True,
    metavar="SECONDS",
    help="Of moments nearer together than this the most similar one is shown.",
)
@click.option("--scan-topic", metavar="TOPIC", help="Laser scans to read.")
@click.option("--image-topic", metavar="TOPIC", help="Camera images to read.")
@options.out
@options.table_format
@options.talk
def similar(**words: Any) -> int:
    """Find the earlier moments that look most like one of a log.

    MODEL is a model file or a results folder; what it remembers are the exemplars of its
    clusters' parts, each with log and time. Writes similar.csv into DIR/similar.
    """
    from mpap_cli.cli.printing import print_similar
    from mpap_cli.commands.inputs.selection import LogSelection
    from mpap_cli.commands.similar import SimilarRequest
    from mpap_cli.commands.similar import similar as run

    request = SimilarRequest(
        model=words["model"],
        at=words["at"],
        out=words["out"],
        count=words["count"],
        apart_s=words["apart"],
    )
    selection = LogSelection(
        sensor=words["sensor"], scan_topic=words["scan_topic"], image_topic=words["image_topic"]
    )
    found = run(selection, request)
    print_similar(found, words["shape"])
    return found.exit_code
