"""Whatever a model file holds, every command that takes one refuses it in one line or uses it."""

import contextlib
import io
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchmarks.measuring.guarded import Limits, guarded
from mpap_cli.cli.main import main
from mpap_cli.outputs.model_file import read_model, write_model

CAMERA = str(Path(__file__).parents[2] / "fixtures" / "camera-a.mcap")
LIMITS = Limits(seconds=20, memory_mb=512)
EXAMPLES = max(3, settings().max_examples // 20)  # each in a process of its own
VALUES = (-1, 0, 1, 7, 2**31, 2**53, 2**62, -(2**63), 1e-300, 1e17, 1e38, np.inf, np.nan)


def call(*words: str) -> tuple[int, str]:
    """Run a command; return its exit code and what it said on stderr."""
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        try:
            main(words)
        except SystemExit as left:
            return int(left.code or 0), said.getvalue()
    return 0, said.getvalue()


@pytest.fixture(scope="module")
def learnt(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of two models; the modules of every command have been imported."""
    folder = tmp_path_factory.mktemp("learnt")
    for name, end in (("a", "20"), ("b", "12")):
        assert call("learn", CAMERA, "--end", end, "-o", str(folder / name))[0] == 0
    assert all(code == 0 for code, _ in used(folder / "a" / "learn" / "model.npz", folder))
    return folder


def used(model: Path, folder: Path) -> list[tuple[int, str]]:
    """Return how each command that takes a model ended."""
    part, out = ("--end", "3", "--jobs", "1"), ("-o", str(folder / "used"))
    path, other = str(model), str(folder / "b" / "learn" / "model.npz")
    return [
        call("info", path),
        call("predict", path, CAMERA, *part, *out),
        call("novelty", CAMERA, "--model", path, *part, *out),
        call("novelty", CAMERA, "--model", path, "--sensor", "scan", *part, *out),
        call("learn", CAMERA, "--model", path, *part, *out),
        call("merge", path, other, *out),
        call("evaluate", CAMERA, "--model", path, "--end", "12", "--jobs", "1", *out),
    ]


def judge(model: Path, folder: Path) -> list[int]:
    """Use a model in a process with limits; return the exit codes."""
    outcome = guarded(partial(used, model, folder), LIMITS)

    assert not outcome.crash, outcome.crash
    assert not outcome.is_late
    assert outcome.result is not None
    for code, said in outcome.result:
        assert code in {0, 1, 2, 3}
        assert all(line.startswith("mpap: ") for line in said.splitlines() if line)
    return [code for code, _ in outcome.result]


@given(data=st.data())
@settings(max_examples=EXAMPLES, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_mutated_model_is_refused_or_used(
    learnt: Path, tmp_path: Path, data: st.DataObject
) -> None:
    """Values of one array, or its length, or a figure of the header may be anything."""
    header, arrays = read_model(learnt / "a" / "learn" / "model.npz")
    name = data.draw(st.sampled_from(sorted(arrays)))
    odd = arrays[name].copy()
    if odd.dtype.kind in "if" and odd.size:
        fitting = [x for x in VALUES if odd.dtype.kind == "f" or isinstance(x, int)]
        flat = odd.reshape(-1)
        flat[data.draw(st.integers(0, odd.size - 1) | st.just(slice(None)))] = data.draw(
            st.sampled_from(fitting)
        )
    if odd.ndim and data.draw(st.booleans()):
        odd = odd[: data.draw(st.integers(0, len(odd)))]
    path = tmp_path / "model.npz"
    write_model(path, header, {**arrays, name: odd})

    codes = judge(path, learnt)

    assert len(codes) == 7


@pytest.mark.parametrize(
    ("key", "value"),
    [("n_iter", float("inf")), ("n_iter", -1), ("logs", [{"start_ns": 10**30}]), ("kind", None)],
)
def test_a_header_that_cannot_be_is_refused_by_all(
    learnt: Path, tmp_path: Path, key: str, value: Any
) -> None:
    """Numbers beyond all counting and parts of other kinds end every command with 1."""
    header, arrays = read_model(learnt / "a" / "learn" / "model.npz")
    if key == "logs":
        value = [{**log, **value[0]} for log in header["collision"]["logs"]]
    header["collision"][key] = value
    path = tmp_path / "model.npz"
    write_model(path, header, arrays)

    codes = judge(path, learnt)

    assert codes == [1] * 7


def test_points_of_other_lengths_are_refused(learnt: Path, tmp_path: Path) -> None:
    """Meta-points that are no embedded histograms would be compared with what is."""
    header, arrays = read_model(learnt / "a" / "learn" / "model.npz")
    path = tmp_path / "model.npz"
    name = "collision.meta_points.normalised"
    write_model(path, header, {**arrays, name: np.array(False)})

    code, said = call("info", str(path))

    assert code == 1
    assert "meta_points.normalised does not fit" in said
