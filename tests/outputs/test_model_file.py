"""The model file is checked before it is believed."""

import io
import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.errors import ModelError
from mpap_cli.outputs.model_file import FORMAT, find_model, read_model, write_model

ARRAYS: dict[str, np.ndarray[Any, np.dtype[Any]]] = {
    "sums": np.arange(12, dtype=np.float64).reshape(3, 4),
    "is_cluster_point": np.array([True, False]),
    "none": np.empty((0, 7), dtype=np.float32),
    "scalar": np.array(5, dtype=np.int64),
    "labels": np.array([-1, 1], dtype=np.int8),
}
HEADER = {"settings": {"theta": "0.08"}, "logs": ["day1.bag"]}


def header_member(**changes: object) -> bytes:
    """Return the bytes of a header member with some entries changed."""
    record = {"format": FORMAT, "version": 1, "header": {}, "arrays": [], **changes}
    stream = io.BytesIO()
    np.save(stream, np.frombuffer(json.dumps(record).encode(), dtype=np.uint8))
    return stream.getvalue()


def npy(header: str, content: bytes = b"") -> bytes:
    """Return an array member with this header text."""
    text = header.encode()
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + content


def zip_of(path: Path, members: dict[str, bytes], packing: int = zipfile.ZIP_STORED) -> Path:
    """Write a zip with these members."""
    with zipfile.ZipFile(path, "w", packing) as archive:
        for name, content in members.items():
            archive.writestr(f"{name}.npy", content)
    return path


def test_models_round_trip(tmp_path: Path) -> None:
    """Header and arrays come back with types and shapes."""
    path = tmp_path / "model.npz"

    write_model(path, HEADER, ARRAYS)
    header, arrays = read_model(path)

    assert header == HEADER
    assert arrays.keys() == ARRAYS.keys()
    for name, array in arrays.items():
        assert array.dtype == ARRAYS[name].dtype
        np.testing.assert_array_equal(array, ARRAYS[name], strict=True)
        assert array.flags.writeable


def test_same_model_same_bytes(tmp_path: Path) -> None:
    """Neither date nor order of the arrays, nor their layout in memory, changes the bytes."""
    turned = {name: ARRAYS[name] for name in reversed(ARRAYS)}
    turned["sums"] = np.asfortranarray(ARRAYS["sums"]).astype(">f8")

    write_model(tmp_path / "a.npz", HEADER, ARRAYS)
    write_model(tmp_path / "b.npz", dict(reversed(HEADER.items())), turned)

    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_numpy_opens_a_model(tmp_path: Path) -> None:
    """A model is an ordinary npz file without pickles."""
    write_model(tmp_path / "model.npz", HEADER, ARRAYS)

    with np.load(tmp_path / "model.npz", allow_pickle=False) as archive:
        assert set(archive) == {"header", *ARRAYS}
        np.testing.assert_array_equal(archive["sums"], ARRAYS["sums"])


@pytest.mark.parametrize("array", [np.array(["text"]), np.array([None]), np.array([1j])])
def test_only_numbers_are_written(tmp_path: Path, array: np.ndarray[Any, np.dtype[Any]]) -> None:
    """Objects and texts have no place in a model."""
    with pytest.raises(ValueError, match="x holds no numbers"):
        write_model(tmp_path / "model.npz", {}, {"x": array})


def test_no_array_takes_the_place_of_the_header(tmp_path: Path) -> None:
    """The name of the header is taken."""
    with pytest.raises(ValueError, match="cannot be named header"):
        write_model(tmp_path / "model.npz", {}, {"header": np.zeros(1)})


def test_missing_file_and_folder_are_named(tmp_path: Path) -> None:
    """A path that leads to no file is one line."""
    with pytest.raises(ModelError, match="there is no such file; check the path of the model"):
        read_model(tmp_path / "model.npz")
    with pytest.raises(ModelError, match="cannot be read"):
        read_model(tmp_path)


@pytest.mark.parametrize("content", [b"", b"text", b"PK\x05\x06" + bytes(18)])
def test_file_that_is_no_model_is_named(tmp_path: Path, content: bytes) -> None:
    """Any other file is one line."""
    path = tmp_path / "model.npz"
    path.write_bytes(content)

    with pytest.raises(ModelError, match=r"model.npz: not a whole model of mpap"):
        read_model(path)


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ({"format": "mpap recording"}, "not an mpap model file"),
        ({"version": 2}, "format version 2, this mpap reads version 1"),
        ({"version": None}, "format version None"),
        ({"arrays": ["sums"]}, r"There is no item named 'sums.npy'"),
        ({"arrays": 3}, "not a whole model"),
        ({"arrays": ["header", "header"]}, "one is there twice"),
        ({"arrays": [1]}, "have no names"),
        ({"header": []}, "header is no record"),
    ],
)
def test_header_is_checked(tmp_path: Path, changes: dict[str, object], found: str) -> None:
    """Other formats, other versions and missing members are told."""
    path = zip_of(tmp_path / "model.npz", {"header": header_member(**changes)})

    with pytest.raises(ModelError, match=found):
        read_model(path)


def test_header_must_be_a_record(tmp_path: Path) -> None:
    """A header that is a list is no header."""
    stream = io.BytesIO()
    np.save(stream, np.frombuffer(b"[1]", dtype=np.uint8))

    with pytest.raises(ModelError, match="header is no record"):
        read_model(zip_of(tmp_path / "model.npz", {"header": stream.getvalue()}))


@pytest.mark.parametrize(
    "member",
    [
        b"",
        npy("{'descr': '<f8', 'fortran_order': False, 'shape': (9000000000000,), }\n"),
        npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1, -1), }\n", bytes(8)),
        npy("{'descr': '|O', 'fortran_order': False, 'shape': (1,), }\n", bytes(8)),
        npy("{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (1,), }\n", bytes(8)),
        npy("{'descr': '<f8', 'fortran_order': True, 'shape': (1,), }\n", bytes(8)),
        npy("{'descr': '<i3', 'fortran_order': False, 'shape': (1,), }\n", bytes(3)),
        npy("{'descr': '<b8', 'fortran_order': False, 'shape': (1,), }\n", bytes(8)),
        npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }\n", bytes(7)),
        npy("{'descr': '<f8', 'fortran_order': False, 'shape': (" + "9," * 2000 + "), }\n"),
        npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1 1), }\n", bytes(8)),
        npy("(" * 60_000),
        b"\x93NUMPY\x02\x00" + bytes(8),
    ],
)
def test_hostile_arrays_are_refused(tmp_path: Path, member: bytes) -> None:
    """An array that declares more than it holds, or anything but numbers, is not read."""
    members = {"header": header_member(arrays=["x"]), "x": member}

    with pytest.raises(ModelError, match=r"model.npz: not a whole model"):
        read_model(zip_of(tmp_path / "model.npz", members))


def test_packed_members_are_refused(tmp_path: Path) -> None:
    """Packed members could unfold to any size."""
    path = zip_of(tmp_path / "model.npz", {"header": header_member()}, zipfile.ZIP_DEFLATED)

    with pytest.raises(ModelError, match=r"header.npy is packed"):
        read_model(path)


def test_member_larger_than_the_file_is_refused(tmp_path: Path) -> None:
    """Sizes are held against the file before memory is taken."""
    path = zip_of(tmp_path / "model.npz", {"header": header_member()})
    content = bytearray(path.read_bytes())
    entry = content.rindex(b"PK\x01\x02")
    content[entry + 20 : entry + 28] = (2**31).to_bytes(4, "little") * 2
    path.write_bytes(content)

    with pytest.raises(ModelError, match="declares 2147483648 bytes in a file of"):
        read_model(path)


@given(data=st.data())
def test_damaged_model_is_one_line(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    """Cut off or with bytes changed, a model is read or is a ModelError, nothing else."""
    path = tmp_path_factory.mktemp("model") / "model.npz"
    write_model(path, HEADER, ARRAYS)
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content[: data.draw(st.integers(0, len(content)) | st.just(len(content)))])

    message = ""
    try:
        read_model(path)
    except ModelError as error:
        message = str(error)

    assert message.isprintable()


def test_model_of_an_out_folder_is_found(tmp_path: Path) -> None:
    """The model of learn stands for the folder, else that of merge, else an error."""
    (tmp_path / "merge").mkdir()
    with pytest.raises(ModelError, match=r"no learn/model.npz and no merge/model.npz"):
        find_model(tmp_path)
    merged = tmp_path / "merge" / "model.npz"
    merged.touch()
    assert find_model(tmp_path) == merged
    learnt = tmp_path / "learn" / "model.npz"
    learnt.parent.mkdir()
    learnt.touch()

    found = find_model(tmp_path)

    assert found == learnt
    assert find_model(merged) == merged
