"""Unpacking of chunks, without believing the sizes that they declare."""

import bz2
import threading
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from zstandard import ZstdDecompressor

MAX_CHUNK_BYTES = 1 << 30
"""A chunk that declares more is taken for broken, before any memory is asked for."""

_TOO_LARGE = "it is larger than declared"


def decompress(compression: str, packed: bytes, size: int) -> tuple[bytes, str]:
    """Unpack a chunk; never more than ``size`` bytes, and as many as come out of a cut one.

    Returns
    -------
    bytes
        The unpacked bytes; empty if the packed ones are wrong.
    str
        What is wrong with them; empty if nothing is.

    Examples
    --------
    >>> decompress("bz2", bz2.compress(b"scan"), 4)
    (b'scan', '')
    >>> decompress("bz2", b"scan", 4)
    (b'', 'bz2 cannot unpack it')
    """
    if size > MAX_CHUNK_BYTES:
        return b"", f"it declares {size:,} bytes"
    if compression not in DECOMPRESSORS:
        return b"", f"its compression {compression!r} is unknown"
    try:
        unpacked = DECOMPRESSORS[compression](packed, size)
    except (OSError, RuntimeError, ValueError, EOFError, MemoryError):
        return b"", f"{compression} cannot unpack it"
    return unpacked, "" if len(unpacked) == size else "it is cut off"


def _plain(packed: bytes, size: int) -> bytes:
    return packed[:size]


def _bz2(packed: bytes, size: int) -> bytes:
    unpack = bz2.BZ2Decompressor()
    return _checked(unpack.decompress, packed, size)


def _lz4(packed: bytes, size: int) -> bytes:
    from lz4.frame import (  # type: ignore[import-untyped]  # noqa: PLC0415  # few logs need it
        LZ4FrameDecompressor,
    )

    return _checked(LZ4FrameDecompressor().decompress, packed, size)


def _checked(unpack: Callable[[bytes, int], bytes], packed: bytes, size: int) -> bytes:
    """Unpack a chunk and go on to the checksum behind it, which fails as broken bytes do."""
    unpacked, more = bytes(unpack(packed, size)), b""
    if len(unpacked) == size:
        with suppress(EOFError):  # the end was reached
            more = unpack(b"", 1)
    if more:
        raise ValueError(_TOO_LARGE)
    return unpacked


def _zstd(packed: bytes, size: int) -> bytes:
    import zstandard  # noqa: PLC0415  # few logs need it

    unpack = _zstd_unpacker(threading.get_ident())
    try:
        # a whole chunk that is as large as declared needs no window to be copied out of
        if zstandard.frame_content_size(packed) == size:
            with suppress(zstandard.ZstdError):
                return unpack.decompress(packed)
        reader = unpack.stream_reader(packed)
        unpacked = reader.read(size)
        if reader.read(1):  # goes on to the checksum behind it
            raise ValueError(_TOO_LARGE)
    except zstandard.ZstdError as err:
        raise ValueError(*err.args) from err
    return unpacked


@lru_cache(maxsize=8)
def _zstd_unpacker(_thread: int) -> "ZstdDecompressor":
    """Return what unpacks for one thread: it takes memory to make, and cannot be shared."""
    from zstandard import ZstdDecompressor  # noqa: PLC0415  # few logs need it

    return ZstdDecompressor()


DECOMPRESSORS: dict[str, Callable[[bytes, int], bytes]] = {
    "": _plain,
    "none": _plain,
    "bz2": _bz2,
    "lz4": _lz4,
    "zstd": _zstd,
}
