"""Reading back what a command left in its results folder."""

import hashlib
from pathlib import Path

from mpap_cli.errors import LogError, OutputError
from mpap_cli.logs.remote.paths import LogPath
from mpap_cli.outputs.publishing import recover
from mpap_cli.outputs.results_record import (
    SETTINGS_NAME,
    InputFile,
    Results,
    read_record,
    sha256_of,
)

__all__ = ["InputFile", "Results", "describe_input", "has_results", "read_results"]


def describe_input(path: LogPath) -> InputFile:
    """Say what was read, so that it is known again wherever it lies.

    Parameters
    ----------
    path : Path or RemotePath
        A file, or a folder with the files of one log.

    Returns
    -------
    InputFile
        Base name, bytes and SHA-256; of a folder, the sum of the bytes and the SHA-256
        of one line ``sha256  name`` for each file. What lies behind a URL and was not read
        whole has no SHA-256; in its place stands that, and the ETag.

    Raises
    ------
    LogError
        If it cannot be read.
    """
    try:
        if not isinstance(path, Path):
            return InputFile(path.name, *path.describe())
        whole = path.resolve()
        if not whole.is_dir():
            return InputFile(whole.name, whole.stat().st_size, sha256_of(whole))
        files = sorted(item for item in whole.iterdir() if item.is_file())
        lines = [f"{sha256_of(item)}  {item.name}\n" for item in files]
        total = hashlib.sha256("".join(lines).encode("utf-8", "surrogateescape"))
        size = sum(item.stat().st_size for item in files)
        return InputFile(whole.name, size, total.hexdigest())
    except OSError as err:
        msg = f"{path.name}: cannot be read ({(err.strerror or str(err)).lower()}); check the file"
        raise LogError(msg) from err


def has_results(folder: Path) -> bool:
    """Tell whether a command has finished in this folder before.

    A commit that was killed is finished first, as by :func:`read_results`.
    """
    recover(folder)
    return (folder / SETTINGS_NAME).is_file()


def read_results(folder: Path) -> Results:
    """Read the settings of a results folder and check that its outputs belong to them.

    A commit that was killed between two renames is finished first.

    Parameters
    ----------
    folder : Path
        ``OUT/<command>``.

    Returns
    -------
    Results
        Settings, inputs and outputs.

    Raises
    ------
    OutputError
        If there are no results, the run that wrote them did not finish, or an output is
        not the one that the settings name (two runs mixed, or edited afterwards).
    """
    recover(folder)
    results = read_record(folder)
    for name, digest in results.outputs.items():
        try:
            found = sha256_of(folder / name)
        except OSError:
            found = ""
        if found != digest:
            what = "is not the file that settings.json names" if found else "is missing"
            msg = (
                f"{folder}: {name} {what} (results of two runs mixed, or changed by hand); "
                f"run mpap {results.command} again"
            )
            raise OutputError(msg)
    return results
