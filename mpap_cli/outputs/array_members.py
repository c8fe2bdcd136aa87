"""Arrays in a zip that numpy.load can open, with the same bytes each time.

Members are stored, not packed: the sizes that the zip declares can then be held against
the bytes that are there, before any memory is taken. Nothing is ever unpickled.
"""

import io
import json
import math
import re
import struct
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from mpap_cli.errors import ModelError, require_finite

_FIRST_DATE = (1980, 1, 1, 0, 0, 0)  # the date of a file would change its bytes
_NAME_LENGTHS = 26  # where a member's local header says how long name and extra field are
_MAGIC = b"\x93NUMPY\x01\x00"
_HEADER = re.compile(
    r"\{'descr': '([<|][biuf][1248])', 'fortran_order': False, 'shape': \(([0-9, ]*)\), \} *\n"
)
_GARBLED = (
    zipfile.BadZipFile,
    RuntimeError,  # encrypted member
    EOFError,
    ValueError,
    KeyError,
    TypeError,
    RecursionError,
    OverflowError,
    struct.error,
)


def write_array(archive: zipfile.ZipFile, name: str, array: NDArray[Any]) -> None:
    """Write one array as the member ``name.npy``.

    Parameters
    ----------
    archive : ZipFile
        Open for writing.
    name : str
        Name without suffix.
    array : ndarray
        Numbers or truth values.

    Raises
    ------
    ValueError
        If the array holds anything else.
    """
    _write(archive, name, array.shape, [array])


def write_joined(archive: zipfile.ZipFile, name: str, parts: Sequence[NDArray[Any]]) -> None:
    """Write arrays as if they had been concatenated, which would copy them.

    Parameters
    ----------
    archive : ZipFile
        Open for writing.
    name : str
        Name without suffix.
    parts : sequence of ndarray
        One at least, of numbers or truth values; they differ in nothing but their length.

    Raises
    ------
    ValueError
        If they differ in more, or hold anything else.
    """
    if len({(part.dtype, part.shape[1:]) for part in parts}) != 1:
        msg = f"{name}: the parts do not make one array"
        raise ValueError(msg)
    _write(archive, name, (sum(len(part) for part in parts), *parts[0].shape[1:]), parts)


def _write(
    archive: zipfile.ZipFile, name: str, shape: tuple[int, ...], parts: Sequence[NDArray[Any]]
) -> None:
    """Write the header of an array and the values of its parts."""
    dtype = parts[0].dtype.newbyteorder("<")
    if dtype.kind not in "biuf":
        msg = f"{name} holds no numbers: {parts[0].dtype}"
        raise ValueError(msg)
    header = io.BytesIO()
    words = {"descr": dtype.str, "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(header, words)
    member = zipfile.ZipInfo(f"{name}.npy", _FIRST_DATE)
    member.create_system = 3  # Unix, wherever it is written
    member.external_attr = 0o644 << 16
    member.file_size = header.tell() + math.prod(shape) * dtype.itemsize
    with archive.open(member, "w") as stream:
        stream.write(header.getbuffer())
        for part in parts:
            plain = np.ascontiguousarray(part, dtype=dtype)
            stream.write(plain.reshape(-1).view(np.uint8).data)  # no copy: chunks are large


def write_record(archive: zipfile.ZipFile, name: str, record: dict[str, Any]) -> None:
    """Write a record as JSON, in an array of bytes."""
    text = json.dumps(record, sort_keys=True)
    write_array(archive, name, np.frombuffer(text.encode(), dtype=np.uint8))


@contextmanager
def open_members(path: Path, what: str) -> Iterator[zipfile.ZipFile]:
    """Open a file of arrays; whatever is wrong with it becomes one line.

    Parameters
    ----------
    path : Path
        The file.
    what : str
        What it should be, for the message: ``model`` or ``recording``.

    Yields
    ------
    ZipFile
        Open for reading.

    Raises
    ------
    ModelError
        If the file, or what is read from it inside the ``with``, is missing or garbled.
    """
    try:
        require_finite(path)
        with zipfile.ZipFile(path) as archive:
            yield archive
    except FileNotFoundError as err:
        msg = f"{path}: there is no such file; check the path of the {what}"
        raise ModelError(msg) from err
    except OSError as err:
        msg = f"{path}: cannot be read ({(err.strerror or str(err)).lower()}); check the path"
        raise ModelError(msg) from err
    except _GARBLED as err:
        msg = f"{path.name}: not a whole {what} of mpap ({_words(err)}); run mpap learn again"
        raise ModelError(msg) from err


def _words(error: BaseException) -> str:
    """Return the text of an error as one short line."""
    words = " ".join(str(error.args[0] if error.args else "garbled").split())
    return "".join(sign if sign.isprintable() else "?" for sign in words)[:100] or "garbled"


def read_array(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    """Read the member ``name.npy``.

    Parameters
    ----------
    archive : ZipFile
        From :func:`open_members`, which turns the errors into a ``ModelError``.
    name : str
        Name without suffix.

    Returns
    -------
    ndarray
        Numbers or truth values; a new array.

    Raises
    ------
    KeyError
        If there is no such member.
    ValueError
        If it is packed, holds objects, or its size is not the one its header declares.
    """
    member = archive.getinfo(f"{name}.npy")
    _check_place(archive, member)
    with archive.open(member) as stream:
        dtype, shape = _read_header(name, stream)
        _check_size(name, dtype, shape, member.file_size - stream.tell())
        content = stream.read()
    return np.frombuffer(content, dtype=dtype).reshape(shape).copy()


def map_array(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    """Return the member ``name.npy`` without reading it: values come when they are looked at.

    Parameters and errors are those of :func:`read_array`, but the checksum, which is that of
    the whole member, is not looked at. The array cannot be written and may be unaligned.
    """
    member = archive.getinfo(f"{name}.npy")
    _check_place(archive, member)
    with Path(archive.filename or "").open("rb") as stream:
        stream.seek(member.header_offset + _NAME_LENGTHS)
        stream.seek(sum(struct.unpack("<HH", stream.read(4))), io.SEEK_CUR)
        begin = stream.tell()
        dtype, shape = _read_header(name, stream)
        n_bytes = begin + member.file_size - stream.tell()
        _check_size(name, dtype, shape, n_bytes)
        return np.memmap(stream, dtype, "r", stream.tell(), shape)


def _check_size(name: str, dtype: np.dtype[Any], shape: tuple[int, ...], n_bytes: int) -> None:
    """Check that an array of this shape has this size."""
    if math.prod(shape) * dtype.itemsize != n_bytes:
        msg = f"{name} declares {'x'.join(map(str, shape))} values in {n_bytes} bytes"
        raise ValueError(msg)


def _check_place(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> None:
    """Check that the bytes which a member declares are in the file, and not packed."""
    if member.compress_type != zipfile.ZIP_STORED or member.file_size != member.compress_size:
        msg = f"{member.filename} is packed"
        raise ValueError(msg)
    size = Path(archive.filename or "").stat().st_size
    if member.header_offset + member.file_size > size:
        msg = f"{member.filename} declares {member.file_size} bytes in a file of {size}"
        raise ValueError(msg)


def _read_header(name: str, stream: IO[bytes]) -> tuple[np.dtype[Any], tuple[int, ...]]:
    """Read type and shape of an array; only the form that numpy itself writes will do."""
    start = stream.read(len(_MAGIC) + 2)
    header = stream.read(int.from_bytes(start[-2:], "little")).decode("latin-1")
    form = _HEADER.fullmatch(header)
    if not start.startswith(_MAGIC) or form is None:
        msg = f"{name} holds no numbers"
        raise ValueError(msg)
    return np.dtype(form[1]), tuple(int(length) for length in form[2].split(",") if length)


def read_record(archive: zipfile.ZipFile, name: str) -> dict[str, Any]:
    """Read a record that :func:`write_record` wrote; ValueError if it is none."""
    record = json.loads(read_array(archive, name).tobytes())
    if not isinstance(record, dict):
        msg = f"{name} is no record"
        raise ValueError(msg)  # noqa: TRY004  # the file is wrong, not the caller
    return record
