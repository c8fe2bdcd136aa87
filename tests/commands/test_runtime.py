"""Kernels are compiled wherever they can be kept, and also where they cannot."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

KERNEL = """
from numba import njit

@njit(cache=True)
def twice(x):
    return 2 * x
"""
USE = """
import logging, os, resource, sys
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each

logging.basicConfig(format="%(message)s")
if sys.argv[1] == "full":
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, -1))
keep_kernels_writable()
with one_thread_each():
    from kernel import twice
    print(twice(2), twice(2.5), os.environ["NUMBA_CACHE_DIR"])
"""


def use_kernel(folder: Path, cache: str, disk: str) -> "subprocess.CompletedProcess[str]":
    """Compile a kernel for two types in a new process whose cache is that folder."""
    (folder / "kernel.py").write_text(KERNEL, encoding="utf-8")
    (folder / "tmp").mkdir()
    names = {"NUMBA_CACHE_DIR": cache, "PYTHONPATH": str(folder), "TMPDIR": str(folder / "tmp")}
    return subprocess.run(  # noqa: S603  # the script above
        [sys.executable, "-c", USE, disk],
        env={**os.environ, **names},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


def test_a_full_disk_under_the_cache_is_one_warning(tmp_path: Path) -> None:
    """The kernels run; they are not kept, and this is said once."""
    cache = tmp_path / "cache"

    used = use_kernel(tmp_path, str(cache), "full")

    assert used.stdout.split() == ["4", "5.0", str(cache)]
    assert used.stderr.splitlines() == [
        "compiled kernels cannot be kept (file too large): the next run compiles again"
    ]
    assert not [path for path in cache.rglob("*") if path.is_file()]


def test_a_cache_that_can_be_written_is_used(tmp_path: Path) -> None:
    """Nothing is said, and the kernels are there for the next run."""
    cache = tmp_path / "cache"

    used = use_kernel(tmp_path, str(cache), "empty")

    assert used.stdout.split() == ["4", "5.0", str(cache)]
    assert used.stderr == ""
    assert len(list(cache.rglob("kernel.twice*.nbc"))) == 2


@pytest.mark.parametrize("kind", ["a file", "nowhere"])
def test_a_cache_that_cannot_be_made_is_one_warning(tmp_path: Path, kind: str) -> None:
    """The kernels run; they are kept in a folder that goes with the process."""
    file = tmp_path / "file"
    file.touch()
    cache = str(file) if kind == "a file" else "/proc/none"

    used = use_kernel(tmp_path, cache, "empty")

    assert used.stdout.split()[:2] == ["4", "5.0"]
    assert used.stdout.split()[2].startswith(str(tmp_path / "tmp" / "mpap-kernels-"))
    assert used.stderr.startswith(f"{cache} cannot be written: kernels are compiled for this run")
    assert list((tmp_path / "tmp").iterdir()) == []
