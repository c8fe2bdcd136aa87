"""Chunks are unpacked whole, or as far as they go; what they declare is not believed."""

import bz2
from concurrent.futures import ThreadPoolExecutor

import lz4.frame  # type: ignore[import-untyped]
import pytest
import zstandard

from mpap_cli.logs.files.chunked.compression import MAX_CHUNK_BYTES, decompress

CONTENT = b"".join(i.to_bytes(4, "little") for i in range(50_000))
SIZED = zstandard.ZstdCompressor().compress(CONTENT)
UNSIZED = zstandard.ZstdCompressor(write_content_size=False).compress(CONTENT)
PACKED = {
    "none": [CONTENT],
    "bz2": [bz2.compress(CONTENT)],
    "lz4": [lz4.frame.compress(CONTENT)],
    "zstd": [SIZED, UNSIZED],
}
CASES = [(name, packed) for name, each in PACKED.items() for packed in each]


@pytest.mark.parametrize(("name", "packed"), CASES)
def test_whole_chunk_is_unpacked(name: str, packed: bytes) -> None:
    """All bytes come back, and nothing is wrong with them."""
    assert decompress(name, packed, len(CONTENT)) == (CONTENT, "")


@pytest.mark.parametrize(("name", "packed"), CASES)
def test_no_more_is_unpacked_than_declared(name: str, packed: bytes) -> None:
    """A packed chunk that holds more than it declares is broken."""
    is_plain = packed == CONTENT

    found, problem = decompress(name, packed, 1000)

    assert found == (CONTENT[:1000] if is_plain else b"")
    assert problem == ("" if is_plain else f"{name} cannot unpack it")


@pytest.mark.parametrize(
    ("name", "packed"),
    [
        ("bz2", bz2.compress(CONTENT)),
        ("lz4", lz4.frame.compress(CONTENT, content_checksum=True)),
        ("zstd", zstandard.ZstdCompressor(write_checksum=True).compress(CONTENT)),
    ],
)
def test_checksum_behind_the_last_byte_counts(name: str, packed: bytes) -> None:
    """All bytes have come out before it is read."""
    changed = packed[:-3] + bytes([packed[-3] ^ 1]) + packed[-2:]

    found, problem = decompress(name, changed, len(CONTENT))

    assert (found, problem) == (b"", f"{name} cannot unpack it")


@pytest.mark.parametrize(("name", "packed"), CASES)
def test_chunk_that_declares_too_much_is_cut_off(name: str, packed: bytes) -> None:
    """Everything that is there comes back, with what is wrong."""
    assert decompress(name, packed, len(CONTENT) + 1) == (CONTENT, "it is cut off")


@pytest.mark.parametrize("packed", [SIZED, UNSIZED])
def test_of_a_cut_chunk_the_beginning_is_unpacked(packed: bytes) -> None:
    """The blocks before the cut come back, whether or not the frame declares its size."""
    found, problem = decompress("zstd", packed[: len(packed) - 10], len(CONTENT))

    assert problem == "it is cut off"
    assert 0 < len(found) < len(CONTENT)
    assert CONTENT.startswith(found)


@pytest.mark.parametrize("packed", [SIZED, UNSIZED])
def test_bytes_that_are_wrong_are_told(packed: bytes) -> None:
    """A frame that cannot be unpacked is named, and the next one is unpacked all the same."""
    wrong = packed[:20] + bytes(len(packed) - 20)

    assert decompress("zstd", wrong, len(CONTENT))[1] != ""
    assert decompress("zstd", b"no frame", len(CONTENT)) == (b"", "zstd cannot unpack it")
    assert decompress("zstd", packed, len(CONTENT)) == (CONTENT, "")


def test_bytes_behind_a_frame_are_left_aside() -> None:
    """Only the first frame of a chunk counts."""
    assert decompress("zstd", SIZED + b"more", len(CONTENT)) == (CONTENT, "")


def test_threads_unpack_at_the_same_time() -> None:
    """Each thread unpacks by itself."""
    with ThreadPoolExecutor(4) as threads:
        found = list(threads.map(lambda _: decompress("zstd", SIZED, len(CONTENT)), range(64)))

    assert found == [(CONTENT, "")] * 64


def test_chunk_that_declares_a_gigabyte_is_not_believed() -> None:
    """No memory is asked for."""
    found, problem = decompress("zstd", SIZED, MAX_CHUNK_BYTES + 1)

    assert (found, problem) == (b"", "it declares 1,073,741,825 bytes")


def test_unknown_compression_is_named() -> None:
    """Its name is in the message."""
    assert decompress("xz", b"", 4) == (b"", "its compression 'xz' is unknown")
