"""Changes of bytes that readers of logs stumble over."""

import struct
from collections.abc import Callable

import numpy as np

Rng = np.random.Generator
Mutation = Callable[[Rng, bytearray], None]

_HUGE = (0, 1, 0x7F, 0xFF, 2**15, 2**16 - 1, 2**31 - 1, 2**32 - 1, 2**40, 2**63 - 1, 2**64 - 1)
_FORMATS = ("<I", ">I", "<Q", ">Q", "<H", ">H")
_ENDS_BYTES = 4096  # headers and indexes stand at the ends
_MOST_BYTES = 4096


def mutated(rng: Rng, content: bytes) -> bytes:
    """Return bytes with one to four changes."""
    changed = bytearray(content)
    names = list(MUTATIONS)
    for _ in range(rng.integers(1, 5)):
        if changed:
            MUTATIONS[names[rng.integers(len(names))]](rng, changed)
    return bytes(changed)


def _place(rng: Rng, content: bytearray) -> int:
    """Return a place anywhere, as often one near the ends."""
    near = min(_ENDS_BYTES, len(content))
    bounds = ((0, len(content)), (0, len(content)), (0, near), (len(content) - near, len(content)))
    begin, end = bounds[int(rng.integers(len(bounds)))]
    return int(rng.integers(begin, end))


def _block(rng: Rng, content: bytearray) -> slice:
    begin = _place(rng, content)
    return slice(begin, min(begin + int(rng.integers(1, _MOST_BYTES)), len(content)))


def _flip(rng: Rng, content: bytearray) -> None:
    for _ in range(rng.integers(1, 9)):
        content[_place(rng, content)] ^= 1 << int(rng.integers(8))


def _overwrite(rng: Rng, content: bytearray) -> None:
    rows = _block(rng, content)
    content[rows] = rng.bytes(rows.stop - rows.start)


def _repeat(rng: Rng, content: bytearray) -> None:
    rows = _block(rng, content)
    content[rows] = bytes([int(rng.choice([0, 0xFF]))]) * (rows.stop - rows.start)


def _cut(rng: Rng, content: bytearray) -> None:
    del content[_place(rng, content) :]


def _remove(rng: Rng, content: bytearray) -> None:
    del content[_block(rng, content)]


def _insert(rng: Rng, content: bytearray) -> None:
    place = _place(rng, content)
    content[place:place] = rng.bytes(int(rng.integers(1, _MOST_BYTES)))


def _duplicate(rng: Rng, content: bytearray) -> None:
    place = _place(rng, content)
    content[place:place] = content[_block(rng, content)]


def _set_number(rng: Rng, content: bytearray) -> None:
    """Set what may be a length: a small number of 16, 32 or 64 bits near a random place."""
    form = _FORMATS[rng.integers(len(_FORMATS))]
    size, begin = struct.calcsize(form), _place(rng, content)
    for place in range(begin, min(begin + 256, len(content) - size)):
        if 0 < struct.unpack_from(form, content, place)[0] < len(content):
            value = int(_HUGE[rng.integers(len(_HUGE))]) % (1 << 8 * size)
            struct.pack_into(form, content, place, value)
            return


MUTATIONS: dict[str, Mutation] = {
    "flip": _flip,
    "overwrite": _overwrite,
    "repeat": _repeat,
    "cut": _cut,
    "remove": _remove,
    "insert": _insert,
    "duplicate": _duplicate,
    "set number": _set_number,
}
