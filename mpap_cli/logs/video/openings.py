"""From which packets of a video decoding can begin, told by their first bytes."""

from collections.abc import Callable, Iterator

_START_CODE = b"\0\0\1"
# The numbers of the standards: what begins a sequence, what holds a picture, which of those
# build on no other.
_H264_PARAMETERS, _H264_SLICES, _H264_IDR = 7, range(1, 6), 5
_H265_PARAMETERS, _H265_SLICES, _H265_IRAP = 33, range(32), range(16, 24)
_VP9_MARKER, _VP9_LONG_PROFILE = 2, 3
_AV1_PARAMETERS, _AV1_FRAMES = 1, (3, 6)
_MORE_FOLLOWS = 128


def opens_video(encoding: str, packet: bytes) -> bool:
    """Tell whether decoding can begin with a packet.

    Parameters
    ----------
    encoding : str
        One of ``VIDEO_ENCODINGS``.
    packet : bytes
        Of H.264 and H.265 NAL units behind start codes (Annex B), of AV1 OBUs with their
        sizes.

    Returns
    -------
    bool
        Whether it holds the parameters of a sequence (VP9 has none), and a picture, if any,
        that builds on no other. What is no video opens none.

    Examples
    --------
    >>> opens_video("vp9", bytes([0b10000010])), opens_video("vp9", bytes([0b10000110]))
    (True, False)
    """
    return _OPENINGS[encoding](packet)


def _nal_units(packet: bytes) -> Iterator[int]:
    """Yield the first byte of each NAL unit."""
    at = packet.find(_START_CODE)
    while 0 <= at < len(packet) - len(_START_CODE):
        at += len(_START_CODE)
        yield packet[at]
        at = packet.find(_START_CODE, at)


def _opens_h264(packet: bytes) -> bool:
    """Look for parameters, and whether the first slice is of an IDR picture."""
    has_parameters = False
    for first in _nal_units(packet):
        kind = first & 31
        if kind in _H264_SLICES:
            return has_parameters and kind == _H264_IDR
        has_parameters = has_parameters or kind == _H264_PARAMETERS
    return has_parameters


def _opens_h265(packet: bytes) -> bool:
    """Look for parameters, and whether the first slice is of an IRAP picture."""
    has_parameters = False
    for first in _nal_units(packet):
        kind = first >> 1 & 63
        if kind in _H265_SLICES:
            return has_parameters and kind in _H265_IRAP
        has_parameters = has_parameters or kind == _H265_PARAMETERS
    return has_parameters


def _opens_vp9(packet: bytes) -> bool:
    """Look for a key frame: marker, profile (2 bits; 3 of the last), repeated, no key frame."""
    if not packet or packet[0] >> 6 != _VP9_MARKER:
        return False
    is_long = packet[0] >> 4 & 3 == _VP9_LONG_PROFILE
    return packet[0] << is_long & 0b1100 == 0


def _opens_av1(packet: bytes) -> bool:
    """Look for parameters, and whether the first frame is a key frame."""
    has_parameters = False
    at = 0
    while at < len(packet):
        kind, has_extension, has_size = packet[at] >> 3 & 15, packet[at] & 4, packet[at] & 2
        at += 2 if has_extension else 1
        size, shift, more = 0, 0, bool(has_size)
        while more and at < len(packet):
            size |= (packet[at] & 127) << shift
            more = packet[at] >= _MORE_FOLLOWS
            shift, at = shift + 7, at + 1
        if kind in _AV1_FRAMES and at < len(packet):
            # one bit: shown before; two: which kind of frame, 0 a key frame
            return has_parameters and packet[at] >> 5 == 0
        has_parameters = has_parameters or kind == _AV1_PARAMETERS
        at = at + size if has_size else len(packet)
    return has_parameters


_OPENINGS: dict[str, Callable[[bytes], bool]] = {
    "h264": _opens_h264,
    "h265": _opens_h265,
    "vp9": _opens_vp9,
    "av1": _opens_av1,
}
