"""Parts of a model that come out of a file, checked before they are believed."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mpap_cli.errors import ModelError, SettingError
from mpap_cli.observations import Clustering, IntArray
from mpap_cli.params import Settings, make_settings, settings_values
from mpap_cli.systems.labelling import LogSource

_MOST = np.iinfo(np.int64).max


@dataclass(frozen=True, slots=True)
class Header:
    """What every model says of itself: its settings, its logs, how its clustering ended."""

    settings: Settings
    logs: tuple[LogSource, ...]
    n_iter: int
    converged: bool


def make_header(
    kind: str, version: int, settings: Settings, logs: Sequence[LogSource], clustering: Clustering
) -> dict[str, Any]:
    """Return the header of a model of some kind; :func:`read_header` is the inverse."""
    return {
        "kind": kind,
        "version": version,
        "profile": settings.profile,
        "settings": settings_values(settings),
        "logs": [asdict(log) for log in logs],
        "n_iter": clustering.n_iter,
        "converged": clustering.converged,
    }


def read_header(header: Mapping[str, Any], kind: str, version: int) -> Header:
    """Read a header that is not trusted.

    Raises
    ------
    ModelError
        If it is of another kind of model or version, or lacks something.
    """
    if header.get("kind") != kind or header.get("version") != version:
        found = f"{header.get('kind')!r} version {header.get('version')!r}"
        msg = f"model: found {found}, expected {kind!r} version {version}; learn it again"
        raise ModelError(msg)
    try:
        settings = make_settings(header["profile"], header["settings"])
        logs = tuple(_log_source(log) for log in header["logs"])
        return Header(settings, logs, _whole(header["n_iter"], 0), bool(header["converged"]))
    except (KeyError, TypeError, ValueError, AttributeError, SettingError) as err:
        msg = f"model: its header does not fit this version ({err!r}); learn it again"
        raise ModelError(msg) from err


def _log_source(log: Mapping[str, Any]) -> LogSource:
    n_presses = log["n_presses"]
    return LogSource(
        name=str(log["name"]),
        start_ns=_whole(log["start_ns"], -_MOST),
        end_ns=_whole(log["end_ns"], -_MOST),
        n_observations=_whole(log["n_observations"], 0),
        n_presses=None if n_presses is None else _whole(n_presses, 0),
        bump_source=str(log["bump_source"]),
    )


def _whole(number: object, least: int) -> int:
    """Return a whole number that arrays can hold too; ValueError if it is anything else."""
    if not isinstance(number, int) or not least <= number <= _MOST:
        msg = f"found {number!r:.40}, expected a whole number"
        raise ValueError(msg)
    return number


def read_array(
    arrays: Mapping[str, NDArray[Any]],
    name: str,
    shape: tuple[int | None, ...],
    dtype: type[np.generic] = np.int64,
) -> NDArray[Any]:
    """Return one array of the file.

    Parameters
    ----------
    arrays : mapping of str to ndarray
        Everything in the file.
    name : str
        Which array.
    shape : tuple of int or None
        What it must have; None: any number.
    dtype : type
        Of its values.

    Raises
    ------
    ModelError
        If it is missing, or of another shape or type.
    """
    array = arrays.get(name)
    if array is None:
        msg = f"model: no array {name} in it; learn it again"
        raise ModelError(msg)
    sizes_fit = len(shape) == array.ndim and all(
        wanted in (None, found) for wanted, found in zip(shape, array.shape, strict=True)
    )
    if not sizes_fit or array.dtype != dtype:
        msg = f"model: {name} is {array.dtype} {array.shape}, expected {shape}; learn it again"
        raise ModelError(msg)
    return array


def are_within(indices: IntArray, size: int) -> bool:
    """Whether all indices are 0 or more and below ``size``."""
    return bool(((indices >= 0) & (indices < size)).all())
