"""A model file made by hand is a model or one line, within bounded memory, and runs no code."""

import io
import json
import os
import pickle
import zipfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from benchmarks.measuring.guarded import Limits, guarded
from mpap_cli.cli.main import main
from mpap_cli.cli.model_text import model_text
from mpap_cli.commands.info import ModelInfo
from mpap_cli.commands.inputs.models import load_models
from mpap_cli.errors import ModelError
from mpap_cli.outputs.model_file import read_model, write_model
from mpap_cli.outputs.recording import read_recording

CAMERA = Path(__file__).parents[2] / "fixtures" / "camera-a.mcap"
LIMITS = Limits(seconds=20, memory_mb=512)
MOST_GROWTH_MB = 128
EXAMPLES = settings().max_examples // 4  # each in a process of its own
EXTREMES = (
    -1,
    0,
    1,
    2**31,
    2**53,
    2**62,
    -(2**63),
    2**63 - 1,
    1e-300,
    1e38,
    np.inf,
    -np.inf,
    np.nan,
)

Arrays = dict[str, NDArray[Any]]


@pytest.fixture(scope="module")
def learnt(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a model of scans and images, and the recording."""
    out = tmp_path_factory.mktemp("learnt")
    with pytest.raises(SystemExit, match="0"):
        main(["learn", str(CAMERA), "--end", "20", "-o", str(out), "-q"])
    return out / "learn"


def use(path: Path) -> str:
    """Read a model and lay out what it knows; return the line if it is refused."""
    try:
        return model_text(ModelInfo(path, load_models(path)))[:0]
    except ModelError as error:
        return str(error)


def replay(path: Path) -> str:
    """Read a recording to its end; return the line if it is refused."""
    try:
        for log in read_recording(path):
            for _ in log.blocks():
                pass
    except ModelError as error:
        return str(error)
    return ""


def judged(work: Callable[[Path], str], path: Path) -> str:
    """Use a file in a process with limits; return the one line or nothing."""
    outcome = guarded(partial(work, path), LIMITS)

    assert not outcome.crash, outcome.crash
    assert not outcome.is_late
    assert outcome.grown_mb < MOST_GROWTH_MB
    assert outcome.result is not None
    assert outcome.result.isprintable()
    return outcome.result


def members_of(path: Path) -> dict[str, bytes]:
    """Return the members of a zip."""
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def npy(array: Any) -> bytes:
    """Return an array as numpy writes it, pickles too."""
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


class Bomb:
    """Leaves a file behind when it is unpickled."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def __reduce__(self) -> Any:
        return os.mkdir, (str(self._path),)


def variants(array: NDArray[Any]) -> Iterator[NDArray[Any]]:
    """Yield arrays that are not what an honest model would hold."""
    yield array.astype(np.float32 if array.dtype == np.float64 else np.float64)
    yield array.reshape(-1) if array.ndim != 1 else array.reshape(1, -1)
    yield array.reshape(-1)[:0]
    if array.ndim:
        yield array[:-1]
        yield array[::-1]
        yield np.repeat(array[:1], len(array), axis=0)
        yield np.swapaxes(array, 0, -1)


@given(data=st.data())
@settings(max_examples=EXAMPLES, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_mutated_array_is_refused_or_harmless(
    learnt: Path, tmp_path: Path, data: st.DataObject
) -> None:
    """Shapes, types, orders and values of one array may be anything."""
    header, arrays = read_model(learnt / "model.npz")
    name = data.draw(st.sampled_from(sorted(arrays)))
    odd = arrays[name].copy()
    if data.draw(st.booleans()) and odd.size and odd.dtype.kind in "if":
        value = data.draw(st.sampled_from(EXTREMES))
        if odd.dtype.kind == "i":
            value = int(np.clip(value, -(2.0**63), 2.0**62)) if np.isfinite(value) else -1
        at = data.draw(st.integers(0, odd.size - 1) | st.just(slice(None)))
        odd.reshape(-1)[at] = value
    else:
        odd = data.draw(st.sampled_from(list(variants(odd))))
    path = tmp_path / "model.npz"
    write_model(path, header, {**arrays, name: odd})

    said = judged(use, path)

    assert "Traceback" not in said


@given(data=st.data())
@settings(max_examples=EXAMPLES, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_mutated_header_is_refused_or_harmless(
    learnt: Path, tmp_path: Path, data: st.DataObject
) -> None:
    """Any part of the header may be any JSON."""
    header, arrays = read_model(learnt / "model.npz")
    part: Any = header
    while True:
        keys = sorted(part) if isinstance(part, dict) else list(range(len(part)))
        key = data.draw(st.sampled_from(keys))
        deeper = isinstance(part[key], dict | list) and len(part[key])
        if not deeper or data.draw(st.booleans()):
            break
        part = part[key]
    texts = st.text(max_size=9) | st.sampled_from(["nan", "-1", "1e999", "\x1b[31m\n", "9" * 9999])
    leaves = st.none() | st.booleans() | st.integers() | st.floats() | texts
    part[key] = data.draw(leaves | st.lists(leaves, max_size=3) | st.just(10**400))
    path = tmp_path / "model.npz"
    write_model(path, header, arrays)

    said = judged(use, path)

    assert "Traceback" not in said


@pytest.mark.parametrize(("name", "work"), [("model", use), ("recording", replay)])
@given(data=st.data())
@settings(max_examples=EXAMPLES, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_changed_bytes_are_refused_or_harmless(
    learnt: Path, tmp_path: Path, name: str, work: Callable[[Path], str], data: st.DataObject
) -> None:
    """Flipped, cut and doubled bytes, near the directory of the zip most of all."""
    content = bytearray((learnt / f"{name}.npz").read_bytes())
    for _ in range(data.draw(st.integers(1, 8))):
        places = st.integers(0, len(content) - 1) | st.integers(
            len(content) - 600, len(content) - 1
        )
        content[data.draw(places)] = data.draw(st.integers(0, 255))
    cut = data.draw(st.just(len(content)) | st.integers(0, len(content)))
    path = tmp_path / "odd.npz"
    path.write_bytes(content[:cut] + content[: data.draw(st.sampled_from([0, 0, 100]))])

    said = judged(work, path)

    assert "Traceback" not in said


def deep_json() -> bytes:
    """Return JSON that is nested a hundred thousand times."""
    return b'{"header":' + b"[" * 100_000 + b"]" * 100_000 + b"}"


@pytest.mark.parametrize(("name", "work"), [("model", use), ("recording", replay)])
@pytest.mark.parametrize("kind", ["pickle", "deep", "many names", "packed", "twice", "paths"])
def test_zips_made_by_hand_are_one_line(
    learnt: Path, tmp_path: Path, name: str, work: Callable[[Path], str], kind: str
) -> None:
    """Pickles, bombs, members twice and members with paths: no code, no file, no memory."""
    members = members_of(learnt / f"{name}.npz")
    record = "header.npy" if name == "model" else "recording.npy"
    other = next(key for key in members if key != record)
    packing = zipfile.ZIP_STORED
    extra: list[tuple[str, bytes]] = []
    if kind == "pickle":
        members[other] = npy(np.array([Bomb(tmp_path / "ran")], dtype=object))
        members[record] = pickle.dumps(Bomb(tmp_path / "ran"))
    elif kind == "deep":
        members[record] = npy(np.frombuffer(deep_json(), np.uint8))
    elif kind == "many names":
        text = json.dumps(
            {
                "format": f"mpap {name}",
                "version": 1,
                "logs": 10**12,
                "header": {},
                "arrays": "x" * 10**6,
            }
        )
        members[record] = npy(np.frombuffer(text.encode(), np.uint8))
    elif kind == "packed":
        packing = zipfile.ZIP_DEFLATED
        members[other] = npy(np.zeros(200_000_000, np.uint8))
    elif kind == "twice":
        extra = [(record, npy(np.frombuffer(b"[]", np.uint8)))]
    else:
        extra = [(odd, b"x") for odd in ("../out.npy", "/out.npy", "a\\..\\b.npy", "\x1b[31m.npy")]
        members[record] = members.pop(record)[:-1]
    path = tmp_path / "odd.npz"
    with zipfile.ZipFile(path, "w", packing) as archive, pytest.MonkeyPatch.context() as patch:
        patch.setattr("warnings.warn", lambda *_, **__: None)  # a name that is there already
        for key, content in (*members.items(), *extra):
            archive.writestr(key, content)

    said = judged(work, path)

    assert said.startswith("odd.npz: not a")
    assert [item.name for item in tmp_path.iterdir()] == ["odd.npz"]
