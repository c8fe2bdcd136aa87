"""What is set once for the whole process: one thread a library, where kernels are kept."""

import functools
import logging
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import mpap_cli
from mpap_cli.logs.scratch import ScratchFolder

LOGGER = logging.getLogger(__name__)
_KEY = "NUMBA_CACHE_DIR"


def keep_kernels_writable() -> None:
    """Send compiled kernels to the user's cache where the package cannot be written.

    Where that cannot be written either they are kept until the process ends. numba reads
    the variable when it is imported, so this comes before.
    """
    package = Path(mpap_cli.__file__).parent
    if _KEY not in os.environ:
        if os.access(package, os.W_OK):
            return
        from platformdirs import user_cache_path  # noqa: PLC0415  # seldom needed

        os.environ[_KEY] = str(user_cache_path("mpap") / "kernels")
    if not _can_hold_files(Path(os.environ[_KEY])):
        LOGGER.warning(
            "%s cannot be written: kernels are compiled for this run alone; "
            "name a folder that can with NUMBA_CACHE_DIR",
            os.environ[_KEY],
        )
        os.environ[_KEY] = str(_folder_of_this_process().path)


def _can_hold_files(folder: Path) -> bool:
    """Whether files can be made in a folder, which is made if it is not there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


@functools.cache
def _folder_of_this_process() -> ScratchFolder:
    """Return a folder that goes when the process ends."""
    return ScratchFolder("mpap-kernels-")


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Keep OpenCV and BLAS to one thread each; the threads of the pipeline are ours."""
    import cv2  # noqa: PLC0415  # only commands that compute need it
    import numpy as np  # noqa: F401, PLC0415  # its BLAS must be there to be limited
    from threadpoolctl import threadpool_limits  # noqa: PLC0415

    _go_on_without_cache()
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        with threadpool_limits(limits=1):
            yield
    finally:
        cv2.setNumThreads(before)


def _go_on_without_cache() -> None:
    """Let no full or broken disk end a run because a kernel cannot be kept or fetched."""
    from numba.core import caching  # noqa: PLC0415  # only commands that compute need it

    @contextmanager
    def guard(_cache: object) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            _tell_of_lost_kernels((error.strerror or str(error)).lower())

    # numba has such a guard for Windows only
    setattr(caching.Cache, "_guard_against_spurious_io_errors", guard)  # noqa: B010  # not ours


@functools.cache
def _tell_of_lost_kernels(reason: str) -> None:
    LOGGER.warning("compiled kernels cannot be kept (%s): the next run compiles again", reason)
