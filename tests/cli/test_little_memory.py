"""Where memory runs out, one line says so."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

FIXTURES = Path(__file__).parents[2] / "fixtures"


@pytest.mark.parametrize(
    ("stage", "lack"),
    [
        ("read_model", MemoryError()),
        ("read_log", MemoryError()),
        ("read_log", RuntimeError("can't start new thread")),
        ("read_log", ImportError("x.so: failed to map segment from shared object")),
    ],
)
def test_too_little_memory_is_one_line(
    run: Callable[..., Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    stage: str,
    lack: Exception,
) -> None:
    """Wherever it is missing, nothing half done is left."""

    def fail(*_words: object, **_more: object) -> None:
        raise lack

    names = {
        "read_model": "mpap_cli.outputs.array_members.zipfile.ZipFile.__init__",
        "read_log": "mpap_cli.logs.replay.Replay.__iter__",
    }
    monkeypatch.setattr(names[stage], fail)
    model = tmp_path / "model.npz"
    model.write_bytes(b"PK")
    words = {"read_model": ["merge", model], "read_log": ["learn", FIXTURES / "indoor-a.bag"]}

    outcome = run(*words[stage], "-o", tmp_path / "out")

    assert outcome.code == 1
    assert outcome.err.splitlines()[-1].startswith("mpap: not enough memory; shorter parts")
    assert not (tmp_path / "out").exists()
