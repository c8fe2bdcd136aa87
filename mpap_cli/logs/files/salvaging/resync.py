"""Behind a broken record: where the records go on."""

import re
from collections.abc import Callable
from typing import BinaryIO

import numpy as np

from mpap_cli.logs.files.chunked.chunks import file_size
from mpap_cli.observations import IntArray

CHAIN = 3
"""So many records that follow one another are believed to be records."""

_SEARCHED_BYTES = 1 << 20
_OVERLAP_BYTES = 64
_MOST_BREAKS = 1000

Walk = Callable[[bytes, IntArray, int], tuple[IntArray, int, int]]
IsRecord = Callable[[bytes, int], bool]


def walk_on(
    walk: Walk, pattern: re.Pattern[bytes], is_record: IsRecord, records: bytes, wanted: IntArray
) -> tuple[IntArray, bool]:
    """Find messages in unpacked records, before and behind whatever is broken.

    Parameters
    ----------
    walk : callable
        Finds messages up to the first broken record, as `_kernels.walk_mcap` does.
    pattern : re.Pattern
        Matches wherever a record might begin.
    is_record : callable
        Tells whether records begin at a place.
    records : bytes
        Unpacked.
    wanted : ndarray of shape (n_wanted,)
        Channels.

    Returns
    -------
    ndarray of shape (4, n)
        As ``walk`` gives it.
    bool
        Whether nothing is broken.
    """
    found, stop, last = walk(records, wanted, 0)
    parts = [found]
    while stop < len(records):
        # a length that is too large swallows what follows, so the last record is suspect
        places = (match.start() for match in pattern.finditer(records, last + 1))
        start = next((place for place in places if is_record(records, place)), None)
        if start is None or len(parts) > _MOST_BREAKS:
            break
        parts[-1] = found[:, found[2] + found[3] <= start]
        found, stop, last = walk(records, wanted, start)
        parts.append(found)
    if len(parts) == 1 and stop == len(records):
        return found, True
    return np.concatenate(parts, axis=1), False


def find_in_file(
    stream: BinaryIO,
    offset: int,
    pattern: re.Pattern[bytes],
    is_record: Callable[[BinaryIO, int], bool],
) -> int | None:
    """Return where in a file records go on; None if they do not.

    Parameters
    ----------
    stream : BinaryIO
        The file.
    offset : int
        Where to begin.
    pattern : re.Pattern
        Matches wherever a record might begin.
    is_record : callable
        Tells whether records begin at a place.
    """
    size = file_size(stream)
    while offset < size:
        stream.seek(offset)
        block = stream.read(_SEARCHED_BYTES + _OVERLAP_BYTES)
        for match in pattern.finditer(block):
            if match.start() >= _SEARCHED_BYTES:
                break
            if is_record(stream, offset + match.start()):
                return offset + match.start()
        offset += _SEARCHED_BYTES
    return None
