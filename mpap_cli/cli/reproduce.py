"""``mpap reproduce``."""

from pathlib import Path
from typing import Any

import click

from mpap_cli.cli import options

_LISTS = ("--indoor", "--outdoor", "--novelty")


class _ListsOfLogs(click.Command):
    """Takes several words after an option that may be given several times."""

    def parse_args(self, context: click.Context, args: list[str]) -> list[str]:
        """Repeat such an option before each of its words."""
        repeated: list[str] = []
        option: str | None = None
        for word in args:
            if word.startswith("-"):
                option = word if word in _LISTS else None
            elif option is not None and repeated[-1] != option:
                repeated.append(option)
            repeated.append(word)
        return super().parse_args(context, repeated)


@click.command(
    cls=_ListsOfLogs,
    epilog="""\b
Examples:
  mpap reproduce
  mpap reproduce --only table-2,figure-7 --textures patches.npz
  mpap reproduce --indoor a1.bag a2.bag --novelty A.bag B.bag A2.bag
""",
)
@click.option(
    "--textures",
    type=click.Path(path_type=Path),
    metavar="DIR|FILE.npz",
    help="Labelled image patches, as for cluster (default: procedural textures).",
)
@click.option("--indoor", multiple=True, metavar="LOG...", help="Logs (default: simulated worlds).")
@click.option(
    "--outdoor", multiple=True, metavar="LOG...", help="Logs (default: simulated worlds)."
)
@click.option(
    "--novelty",
    multiple=True,
    metavar="A B A2",
    help="Camera logs of two places and the first again (default: simulated).",
)
@click.option(
    "--seeds",
    type=click.IntRange(min=1),
    default=10,
    show_default=True,
    metavar="N",
    help="Repeats of what is simulated.",
)
@click.option("--only", metavar="PART,...", help="Such as table-2,figure-10 (default: everything).")
@click.option(
    "--seed",
    type=click.IntRange(min=0, max=2**31),
    default=0,
    show_default=True,
    help="First of the seeds.",
)
@options.out
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    default=2,
    show_default=True,
    metavar="N",
    help="Experiments that run side by side.",
)
@options.table_format
@options.talk
def reproduce(**words: Any) -> int:
    """Make the tables and figures of the paper again, beside its numbers.

    Tables 1 to 4, figures 6 to 18, the stopping distance of section 5.3.3 and the ranges of
    parameters that the text calls good, on data that the tool makes unless yours are named.
    Writes reproduced.csv, reproduced.md and the figures into DIR/reproduce.
    """
    from mpap_cli.cli.printing import print_reproduced
    from mpap_cli.commands.reproduce import ReproduceRequest
    from mpap_cli.commands.reproduce import reproduce as run

    only = words["only"] or ""
    request = ReproduceRequest(
        out=words["out"],
        textures=words["textures"],
        indoor=words["indoor"],
        outdoor=words["outdoor"],
        novelty=words["novelty"],
        seeds=words["seeds"],
        only=tuple(part.strip() for part in only.split(",") if part.strip()),
        jobs=words["jobs"],
        seed=words["seed"],
    )
    found = run(request)
    print_reproduced(found, words["shape"])
    return found.exit_code
