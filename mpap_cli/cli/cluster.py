"""``mpap cluster``."""

from pathlib import Path
from typing import Any

import click

from mpap_cli.cli import options

# a copy, so that --help need not import numpy
METHODS = ("ap", "mpap", "strap", "k-means", "mean-shift", "hdbscan", "denstream")


@click.command(
    epilog="""\b
Examples:
  mpap cluster photographs/
  mpap cluster patches.npz --orders 10 --set theta=0.15
  mpap cluster patches.npz --method mpap --method ap
""",
)
@click.argument("patches", metavar="DIR|FILE.npz", type=click.Path(path_type=Path))
@click.option(
    "--orders",
    type=click.IntRange(1, 1000),
    default=5,
    show_default=True,
    metavar="N",
    help="Orders of the patches, for methods that depend on it.",
)
@click.option(
    "--per-class",
    type=click.IntRange(min=1),
    metavar="N",
    help="At most so many patches of a class, drawn at random (default: all).",
)
@click.option(
    "--method",
    "methods",
    multiple=True,
    type=click.Choice(METHODS),
    help="Methods to run (default: all that are installed).",
)
@options.settings
@options.out
@options.table_format
@options.talk
def cluster(**words: Any) -> int:
    """Compare the paper's clusterers and their peers on image patches whose classes are known.

    DIR holds a folder of images for each class; FILE.npz the arrays patches (n, h, w, 3), RGB,
    uint8, labels (n,) and class_names. Images larger than 104 x 80 are cut into patches of
    52 x 40 pixels. Theta of mpap comes from the patches unless it is set; --profile paper has
    0.2. Writes cluster.csv and members.png into DIR/cluster.
    """
    from mpap_cli.cli.clustered_text import print_clustered
    from mpap_cli.commands.cluster import ClusterRequest
    from mpap_cli.commands.cluster import cluster as run

    request = ClusterRequest(
        patches=words["patches"],
        out=words["out"],
        orders=words["orders"],
        per_class=words["per_class"],
        methods=words["methods"],
    )
    found = run(options.request(words), request)
    print_clustered(found, words["shape"])
    return found.exit_code
