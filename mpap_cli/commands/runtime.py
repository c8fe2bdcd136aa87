"""What is set once for the whole process: one thread a library, where kernels are kept."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import mpap_cli


def keep_kernels_writable() -> None:
    """Send compiled kernels to the user's cache where the package cannot be written.

    numba reads the variable when it is imported, so this comes before.
    """
    package = Path(mpap_cli.__file__).parent
    if "NUMBA_CACHE_DIR" not in os.environ and not os.access(package, os.W_OK):
        from platformdirs import user_cache_path  # noqa: PLC0415  # seldom needed

        os.environ["NUMBA_CACHE_DIR"] = str(user_cache_path("mpap") / "kernels")


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Keep OpenCV and BLAS to one thread each; the threads of the pipeline are ours."""
    import cv2  # noqa: PLC0415  # only commands that compute need it
    import numpy as np  # noqa: F401, PLC0415  # its BLAS must be there to be limited
    from threadpoolctl import threadpool_limits  # noqa: PLC0415

    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        with threadpool_limits(limits=1):
            yield
    finally:
        cv2.setNumThreads(before)
