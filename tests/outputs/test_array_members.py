"""Arrays in a zip: the same bytes however they are written, the same values however read."""

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mpap_cli.errors import ModelError
from mpap_cli.outputs.array_members import (
    map_array,
    open_members,
    read_array,
    write_array,
    write_joined,
)

RANGES = np.arange(12, dtype=np.float32)
TABLE = np.arange(12.0).reshape(4, 3)


@pytest.mark.parametrize("whole", [RANGES, TABLE, RANGES.astype(">f4"), RANGES > 3])
def test_parts_give_the_bytes_of_the_whole(tmp_path: Path, whole: NDArray[Any]) -> None:
    """Arrays written one after the other are one array; an empty part adds nothing."""
    with zipfile.ZipFile(tmp_path / "whole.npz", "w") as archive:
        write_array(archive, "a", whole)

    with zipfile.ZipFile(tmp_path / "parts.npz", "w") as archive:
        write_joined(archive, "a", [whole[:1], whole[1:1], whole[1:]])

    assert (tmp_path / "parts.npz").read_bytes() == (tmp_path / "whole.npz").read_bytes()
    with np.load(tmp_path / "parts.npz") as arrays:
        np.testing.assert_array_equal(arrays["a"], whole)


@pytest.mark.parametrize(
    "parts", [[], [RANGES, RANGES.astype(np.float64)], [TABLE, TABLE[:, :2]], [TABLE, RANGES]]
)
def test_parts_that_make_no_array_are_refused(tmp_path: Path, parts: list[NDArray[Any]]) -> None:
    """Other types or other columns cannot follow one another."""
    with (
        zipfile.ZipFile(tmp_path / "a.npz", "w") as archive,
        pytest.raises(ValueError, match="a: the parts do not make one array"),
    ):
        write_joined(archive, "a", parts)


@pytest.mark.parametrize("before", [b"", b"1", b"123"])
def test_mapped_array_is_the_one_that_is_read(tmp_path: Path, before: bytes) -> None:
    """Wherever its values lie in the file, an array can be looked at without being read."""
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("before", before)
        write_array(archive, "ranges", RANGES)
        write_array(archive, "table", TABLE)

    with open_members(tmp_path / "a.npz", "recording") as archive:
        found = [
            (map_array(archive, name), read_array(archive, name)) for name in ("ranges", "table")
        ]

    for mapped, read in found:
        np.testing.assert_array_equal(mapped, read, strict=True)
        assert not mapped.flags.writeable


def test_mapped_array_of_another_size_is_refused(tmp_path: Path) -> None:
    """An array whose header declares more values than it holds is never looked at."""
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        write_array(archive, "ranges", RANGES)
    content = (tmp_path / "a.npz").read_bytes()
    (tmp_path / "a.npz").write_bytes(content.replace(b"(12,)", b"(13,)"))

    with (
        pytest.raises(ModelError, match="ranges declares 13 values in 48 bytes"),
        open_members(tmp_path / "a.npz", "recording") as archive,
    ):
        map_array(archive, "ranges")
