"""The ``mpap`` command: finds the subcommand, prints errors, sets the exit code."""

import importlib
import io
import os
import sys
from collections.abc import Sequence
from pathlib import Path

import click

from mpap_cli import __version__
from mpap_cli.cli.interruption import ended_by_signals
from mpap_cli.errors import MpapError

_THAT_MATTER = ("numpy", "numba", "opencv_python_headless", "rosbags", "mcap", "scikit_learn")
_NO_ROOM = ("failed to map segment", "can't start new thread")  # a want of memory as well
COMMANDS = {
    "info": "What a log holds and what could be learnt from it.",
    "learn": "Learn clusters and collision probabilities from logs.",
    "evaluate": "Score collision prediction: ROC, AUC, lead times.",
    "predict": "Predict collisions and obstacles in new logs.",
    "novelty": "How much of each log is new, over time.",
    "similar": "The earlier moments most like another one.",
    "compare": "How much of each log the others explain.",
    "extract": "Cut what is worth keeping into new logs.",
    "merge": "Make one model of several.",
    "cluster": "Compare clusterers on labelled image patches.",
    "reproduce": "Make the tables and figures of the paper again.",
    "simulate": "Write the log of a simulated robot, and the truth.",
    "config": "List every setting with its value and origin.",
    "completion": "Print the completion script of a shell.",
}


class LazyGroup(click.Group):
    """Imports a subcommand when it runs, so that ``mpap --help`` costs little."""

    def list_commands(self, _context: click.Context) -> list[str]:
        """Return the names in the order in which one would use them."""
        return list(COMMANDS)

    def get_command(self, _context: click.Context, name: str) -> click.Command | None:
        """Import the module of a command, which holds it under its own name."""
        if name not in COMMANDS:
            return None
        module = importlib.import_module(f"mpap_cli.cli.{name}")
        command: click.Command = getattr(module, name)
        return command

    def format_commands(self, _context: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of commands without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


def _print_version(context: click.Context, _option: click.Parameter, wanted: bool) -> None:
    if not wanted or context.resilient_parsing:
        return
    # importlib.metadata would take longer than all the rest: the records lie beside click
    site_packages = os.path.dirname(os.path.dirname(click.__file__))  # noqa: PTH120  # as fast
    records = sorted(os.listdir(site_packages))  # noqa: PTH208
    versions = dict(
        name.removesuffix(".dist-info").split("-", 1)
        for name in records
        if name.endswith(".dist-info")
    )
    parts = [f"Python {sys.version.split()[0]}"]
    parts += [f"{name} {versions[name]}" for name in _THAT_MATTER if name in versions]
    click.echo(f"mpap {__version__} ({', '.join(parts)})")
    context.exit()


@click.group(
    cls=LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="""\b
Example:
  mpap info day1.bag
  mpap learn day1.bag day2.bag
  mpap evaluate
""",
)
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_print_version,
    help="Show the versions that matter and exit.",
)
def mpap() -> None:
    """Learn from recorded robot logs what the surroundings look like and what means a collision.

    Reads ROS bags and MCAP files with no ROS installed. The way through: info, learn, evaluate,
    novelty.
    """


def _say(text: str) -> None:
    """Print one line on stderr, whatever names from logs hold."""
    from mpap_cli.outputs.text_table import printable

    click.echo(f"mpap: {printable(text)}", err=True)


def _prepare_streams() -> None:
    """Open what the caller has closed (``>&-``); write names that are no text as tables do."""
    if sys.stdout is None:  # a file opened later would take its place
        sys.stdout = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115  # to the end
    if sys.stderr is None:
        sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115  # to the end
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and leave with its exit code."""
    _prepare_streams()
    with ended_by_signals():
        _run(arguments)


def _run(arguments: Sequence[str] | None) -> None:
    """Run a command; errors become one line and an exit code."""
    try:
        code = mpap.main(arguments, prog_name="mpap", standalone_mode=False)
        sys.stdout.flush()
    except MpapError as error:
        _say(str(error))
        sys.exit(error.exit_code)
    except BrokenPipeError:
        # who reads stdout has gone; what Python still holds for it goes nowhere
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except (MemoryError, ImportError, RuntimeError) as error:
        if not isinstance(error, MemoryError) and not any(word in str(error) for word in _NO_ROOM):
            raise
        _say("not enough memory; shorter parts (--start, --end) or fewer logs need less")
        sys.exit(1)
    except OSError as error:
        _say(f"{error.filename or 'output'}: {(error.strerror or str(error)).lower()}")
        sys.exit(1)
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except click.Abort as aborted:
        raise KeyboardInterrupt from aborted
    sys.exit(code if isinstance(code, int) else 0)
