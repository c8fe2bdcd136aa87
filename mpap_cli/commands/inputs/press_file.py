"""The file of ``--bump-from FILE.csv``: presses written by hand."""

from collections.abc import Sequence

from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.logs.reader import LogPath
from mpap_cli.outputs.results_reader import InputFile, describe_input
from mpap_cli.properties.press_files import PressRow, presses_from_csv, rows_of_logs


def presses_by_hand(
    selection: LogSelection, paths: Sequence[LogPath]
) -> dict[str, tuple[PressRow, ...]] | None:
    """Read the file, if presses come from one.

    Parameters
    ----------
    selection : LogSelection
        Says where presses come from.
    paths : sequence of Path or RemotePath
        The logs given; the file must name none but these.

    Returns
    -------
    dict of str to tuple of PressRow, or None
        Rows by base name of the log; None if presses come from elsewhere.

    Raises
    ------
    LogError
        If the file cannot be read.
    UsageError
        If it is no table of presses, or names another log.
    """
    file = selection.press_file
    if file is None:
        return None
    names = [path.name for path in paths]
    return rows_of_logs(presses_from_csv(file), names, f"--bump-from {file.name}")


def press_inputs(selection: LogSelection) -> list[InputFile]:
    """Describe the file for settings.json; nothing if presses come from elsewhere.

    Raises
    ------
    LogError
        If the file cannot be read.
    """
    return [] if selection.press_file is None else [describe_input(selection.press_file)]
