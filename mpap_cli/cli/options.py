"""Options that several commands share, and how their words become typed arguments."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from mpap_cli.params import PROFILES, SCAN_FEATURE_NAMES

if TYPE_CHECKING:
    from mpap_cli.commands.inputs.selection import LogSelection
    from mpap_cli.commands.settings import SettingsRequest

Command = TypeVar("Command", bound=Callable[..., Any])
FEATURES = tuple(name for name in SCAN_FEATURE_NAMES if name != "inverse-min")  # that is robust's
FILE, LOG = click.Path(dir_okay=False, path_type=Path), click.Path(readable=False)


def _together(*decorators: Callable[[Command], Command]) -> Callable[[Command], Command]:
    """Make one decorator of several; the first stands first in the help."""

    def decorate(command: Command) -> Command:
        for decorator in reversed(decorators):
            command = decorator(command)
        return command

    return decorate


def logs(*, required: bool) -> Callable[[Command], Command]:
    """Add the LOG arguments and everything that says what to read from them."""
    return _together(
        click.argument("logs", metavar="LOG...", nargs=-1, required=required, type=LOG),
        click.option("--scan-topic", metavar="TOPIC", help="Laser scans to read."),
        click.option("--image-topic", metavar="TOPIC", help="Camera images to read."),
        click.option(
            "--bump-topic",
            "bump_topics",
            multiple=True,
            metavar="TOPIC[:EXPR][:KIND]",
            help="Bumper; EXPR such as bumper&7, KIND level, edge=FIELD or pulse=SECONDS.",
        ),
        click.option(
            "--bump-from",
            default="topic",
            show_default=True,
            metavar="topic|scan|none|FILE.csv",
            help="Where presses come from; FILE.csv has the columns log, start_s, end_s.",
        ),
        click.option(
            "--bump-distance",
            type=click.FloatRange(0, 1000, min_open=True),
            default=0.25,
            show_default=True,
            metavar="M",
            help="With --bump-from scan: nearer than this is a press.",
        ),
        click.option("--forward", metavar="DEG|tf", help="Direction of travel in the scan."),
        click.option("--start", metavar="TIME", help="12.5, 1:30, RFC 3339 or nanoseconds."),
        click.option("--end", metavar="TIME", help="As --start."),
        click.option(
            "--time-source",
            type=click.Choice(["log", "header"]),
            default="log",
            show_default=True,
            help="Time of recording or of the message's header.",
        ),
        click.option(
            "--msgs",
            multiple=True,
            type=click.Path(file_okay=False, path_type=Path),
            metavar="DIR",
            help="Folder with .msg files of types the log does not define.",
        ),
        click.option("--strict", is_flag=True, help="Fail where part of a log is damaged."),
    )


def sensor(command: Command) -> Command:
    """Add which sensors are read."""
    return click.option(
        "--sensor",
        type=click.Choice(["auto", "scan", "image", "both"]),
        default="auto",
        show_default=True,
        help="Laser scans, camera images, or what the logs have.",
    )(command)


def scan_geometry(command: Command) -> Command:
    """Add what a model is to see of a scan."""
    return _together(
        click.option("--fov", metavar="DEG|FROM,TO", help="Field of view about forward."),
        click.option("--max-range", metavar="M", help="Cap on ranges."),
    )(command)


def settings(command: Command) -> Command:
    """Add the options that end in settings."""
    return _together(
        click.option(
            "--profile",
            type=click.Choice(list(PROFILES)),
            help="robust: the default; paper: Ott & Ramos 2013 (implied by --feature, --bins).",
        ),
        click.option(
            "--set",
            "pairs",
            multiple=True,
            metavar="KEY=VALUE",
            help="Any other setting; 'mpap config' lists them.",
        ),
        click.option("--config", type=FILE, metavar="FILE.toml", help="Settings."),
        click.option("--seed", type=click.IntRange(min=0), help="Seed of all that is random."),
    )(command)


def feature(several: str = "") -> Callable[[Command], Command]:
    """Add --feature and --bins; ``several`` names the choice that stands for many."""
    choices = [*FEATURES, *([several] if several else [])]
    return _together(
        click.option("--feature", type=click.Choice(choices), help="Value of a bin."),
        click.option("--bins", metavar="N[,N]" if several else "N", help="Bins, such as 6."),
    )


def out(command: Command) -> Command:
    """Add the results folder."""
    return click.option(
        "-o",
        "--out",
        type=click.Path(path_type=Path),
        default=Path("mpap-out"),
        envvar="MPAP_OUT",
        show_default=True,
        show_envvar=True,
        metavar="DIR",
        help="Results folder.",
    )(command)


def jobs(command: Command) -> Command:
    """Add the number of threads."""
    return click.option(
        "--jobs",
        type=click.IntRange(min=1),
        default=2,
        show_default=True,
        metavar="N",
        help="1: no thread beside; 2 or more: reading runs in a thread of its own.",
    )(command)


def threshold(command: Command) -> Command:
    """Add the probability from which a collision is announced."""
    return click.option(
        "--threshold",
        type=click.FloatRange(0, 1),
        default=0.2,
        show_default=True,
        metavar="P",
        help="A collision is announced from this probability up.",
    )(command)


def table_format(command: Command) -> Command:
    """Add the shape of what is printed."""
    return click.option(
        "--format",
        "shape",
        type=click.Choice(["table", "csv", "json"]),
        default="table",
        show_default=True,
        help="Shape of what is printed.",
    )(command)


def _talk(_context: click.Context, option: click.Parameter, count: int) -> int:
    """Set how much is said on stderr, before anything else runs."""
    from mpap_cli.cli.talk import be_quiet, talk_on_stderr

    if option.name == "verbose":
        talk_on_stderr(verbose=count > 0)
    elif count:
        be_quiet()
    return count


def talk(command: Command) -> Command:
    """Add -v and -q."""
    return _together(
        click.option(
            "-v",
            "--verbose",
            count=True,
            is_eager=True,
            expose_value=False,
            callback=_talk,
            help="Say more on stderr.",
        ),
        click.option(
            "-q",
            "--quiet",
            is_flag=True,
            expose_value=False,
            callback=_talk,
            help="Say nothing but errors.",
        ),
    )(command)


def selection(words: dict[str, Any]) -> "LogSelection":
    """Turn the words of :func:`logs` into a record."""
    from mpap_cli.commands.inputs.selection import LogSelection

    return LogSelection(
        logs=words["logs"],
        sensor=words.get("sensor", "scan"),
        scan_topic=words["scan_topic"],
        image_topic=words["image_topic"],
        bump_topics=words["bump_topics"],
        bump_from=words["bump_from"],
        bump_distance_m=words["bump_distance"],
        forward=words["forward"],
        start=words["start"],
        end=words["end"],
        time_source=words["time_source"],
        msgs=words["msgs"],
        strict=words["strict"],
    )


def request(words: dict[str, Any]) -> "SettingsRequest":
    """Turn the words of :func:`settings`, :func:`feature`, :func:`scan_geometry` into a record."""
    from mpap_cli.commands.settings import SettingsRequest

    return SettingsRequest(
        profile=words["profile"],
        feature=words.get("feature"),
        bins=words.get("bins"),
        config=words["config"],
        pairs=words["pairs"],
        flags={
            key: str(words[name])
            for key, name in (("fov", "fov"), ("max-range", "max_range"), ("seed", "seed"))
            if words.get(name) is not None
        },
    )
