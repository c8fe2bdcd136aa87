"""Which logs belong together, so that none of them is learnt while another is scored."""

import csv
import json
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from mpap_cli.errors import MpapError, UsageError, require_finite
from mpap_cli.observations import ObservedLog

MOST_SECONDS = 10.0
"""So long a regular expression may take for all paths: some never end."""

_MOST_SHOWN = 200
_SEARCH = """
import json, re, sys
groups, *paths = json.load(sys.stdin)
found = [re.search(groups, path) for path in paths]
print(json.dumps([one and one.group(1) for one in found]))
"""


def group_names(logs: Sequence[ObservedLog], groups: str) -> tuple[str, ...]:
    """Name the group of each log.

    Parameters
    ----------
    logs : sequence of ObservedLog
        Logs in the order given.
    groups : str
        ``folder`` (the parent folder), a file ``*.csv`` with columns log and group, or a
        regular expression: what its first bracket matches in the path.

    Returns
    -------
    tuple of str
        One name a log.

    Raises
    ------
    UsageError
        If the file or expression is none, or a log has no group.

    Examples
    --------
    >>> log = ObservedLog("x1", "day/x1.bag", 0, 1, 0.0, None, (), "", lambda: iter(()))
    >>> group_names([log], "folder"), group_names([log], "([a-z])1")
    (('day',), ('x',))
    """
    if groups == "folder":
        return tuple(Path(log.path).absolute().parent.name for log in logs)
    if groups.endswith(".csv"):
        listed = _listed_groups(Path(groups))
        return tuple(_listed_group(log, listed, groups) for log in logs)
    _check(groups)
    return _matched_groups([log.path for log in logs], groups)


def _check(groups: str) -> None:
    """Require a regular expression with a bracket."""
    try:
        expression = re.compile(groups)
    except (re.error, OverflowError, RecursionError) as error:
        msg = f"--groups {groups[:_MOST_SHOWN]}: no regular expression: {error}"
        raise UsageError(msg) from error
    if expression.groups == 0:
        msg = f"--groups {groups}: found no bracket; put one around what names the group"
        raise UsageError(msg)


def _matched_groups(paths: Sequence[str], groups: str) -> tuple[str, ...]:
    """Return what the first bracket matches in each path; a process of its own can be ended."""
    words = [sys.executable, "-I", "-S", "-c", _SEARCH]
    try:
        done = subprocess.run(  # noqa: S603  # Python itself, with a text of ours
            words,
            input=json.dumps([groups, *paths]),
            capture_output=True,
            text=True,
            check=True,
            timeout=MOST_SECONDS,
        )
    except subprocess.TimeoutExpired as error:
        msg = (
            f"--groups {groups[:_MOST_SHOWN]}: found no match within {MOST_SECONDS:g} s; "
            "take out what repeats a repeat"
        )
        raise UsageError(msg) from error
    found: list[str | None] = json.loads(done.stdout)
    for path, name in zip(paths, found, strict=True):
        if name is None:
            msg = f"--groups {groups}: matches nothing in {path}; widen it"
            raise UsageError(msg)
    return tuple(name for name in found if name is not None)


def _listed_groups(path: Path) -> dict[str, str]:
    """Read the columns log and group of a CSV."""
    try:
        require_finite(path)
        with path.open(encoding="utf-8-sig", newline="") as file:
            table = csv.DictReader(file)
            if not {"log", "group"} <= set(table.fieldnames or ()):
                found = ", ".join(table.fieldnames or ())[:_MOST_SHOWN] or "none"
                msg = f"--groups {path.name}: found columns {found}; need log and group"
                raise UsageError(msg)
            return {row["log"]: row["group"] or "" for row in table}
    except OSError as error:
        msg = f"--groups {path}: {(error.strerror or str(error)).lower()}"
        raise MpapError(msg) from error
    except (UnicodeDecodeError, csv.Error) as error:
        msg = f"--groups {path.name}: cannot be read: {error}"
        raise UsageError(msg) from error


def _listed_group(log: ObservedLog, listed: dict[str, str], groups: str) -> str:
    """Return the group that a file gives to a log, by base name or path."""
    for key in (log.path, Path(log.path).name, log.name):
        if listed.get(key):
            return listed[key]
    msg = f"--groups {Path(groups).name}: no group for {log.name}; add a line for it"
    raise UsageError(msg)
