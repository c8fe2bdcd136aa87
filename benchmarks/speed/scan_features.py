"""From a log of scans to features: the kernel alone, and with reading the log."""

import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import zstandard
from numpy.typing import NDArray
from rosbags.highlevel import AnyReader

from benchmarks.measuring.processes import in_turns, simulated
from benchmarks.measuring.table import Row
from benchmarks.speed.scan_logs import as_bag, as_database, beside_images, scans_alone
from mpap_cli.features.scans import _kernels
from mpap_cli.features.scans.scan_bins import lay_out_bins
from mpap_cli.features.scans.scan_cleaning import range_limits
from mpap_cli.features.scans.scan_features import ScanEmbedder
from mpap_cli.logs.reader import open_log
from mpap_cli.logs.replay import Replay
from mpap_cli.logs.survey import survey_log
from mpap_cli.logs.topics import TopicChoice, choose_roles
from mpap_cli.observations import Float32Array, ScanGeometry
from mpap_cli.params import Settings, make_settings

F32 = NDArray[np.float32]
SCANS, BEAMS, BINS = 20_000, 181, 12
REPEATS = 7
_MAGIC_BYTES = 8
_CHUNK = 0x06


def kernel(_folder: Path) -> list[Row]:
    """Take five features of 20,000 scans, against a copy of the ranges and plain numpy."""
    rng = np.random.default_rng(0)
    ranges = rng.uniform(0.0, 9.0, (SCANS, BEAMS)).astype(np.float32)
    geometry = ScanGeometry(BEAMS, -np.pi / 2, np.pi / 180, 0.02, 8.0)
    params = make_settings("paper", {"bins": str(BINS)}).scan
    layout = lay_out_bins(geometry, 0.0, params)
    limits = range_limits(geometry, params).as_array()
    statistics = np.arange(_kernels.SLOPE)
    held = np.full((statistics.size, BINS), np.nan)

    def fused() -> object:
        return _kernels.bin_block(ranges, limits, layout.runs, layout.stretch, statistics, held)

    mine, copied, plain = in_turns([fused, ranges.copy, lambda: vectorised(ranges)], REPEATS)
    work = f"5 features, {SCANS:,} scans of {BEAMS} beams"
    return [
        Row(work=work, mpap=_ms(mine), beside=beside, peer=_ms(times), unit="ms", goal=goal)
        for beside, times, goal in (
            ("memcpy of the ranges", copied, "<="),
            ("vectorised numpy", plain, ">="),
        )
    ]


def reading(folder: Path) -> list[Row]:
    """Read one hour of scans and take one feature of 12 bins, checksums included."""
    path = scans_alone(simulated(folder, "indoor"), folder / "scans.mcap")
    settings = make_settings("paper", {"bins": str(BINS)})
    works = [
        lambda: _by_mpap(path, settings),
        lambda: _by_rosbags(path),
        lambda: _unpacked_bytes(path),
    ]
    mine, rosbags, limit = in_turns(works, REPEATS)
    work = "1 h of scans, MCAP zstd -> 12-bin features"
    return [
        Row(work=work, mpap=_ms(mine), beside=beside, peer=_ms(times), unit="ms", goal=goal)
        for beside, times, goal in (
            ("rosbags deserialize + vectorised numpy", rosbags, ">= 10x"),
            ("read + decompress + crc32", limit, "<= 1.5x"),
        )
    ]


def chosen(folder: Path) -> list[Row]:
    """Read ten minutes of scans that stand beside images, in chunks of their own."""
    alone = scans_alone(simulated(folder, "indoor", 10), folder / "scans-10min.mcap")
    beside = beside_images(alone, folder / "scans-and-images.mcap")
    settings = make_settings("paper", {"bins": str(BINS)})
    works = [lambda: _by_mpap(beside, settings), lambda: _by_mpap(alone, settings)]
    mine, theirs = in_turns(works, REPEATS)
    n_mb = beside.stat().st_size / 1e6
    return [
        Row(
            work=f"10 min of scans -> features, {n_mb:.0f} MB with images",
            mpap=_ms(mine),
            beside="the scans alone",
            peer=_ms(theirs),
            unit="ms",
            goal="<=",
        )
    ]


def containers(folder: Path) -> list[Row]:
    """Read ten minutes of scans out of the other containers."""
    alone = scans_alone(simulated(folder, "indoor", 10), folder / "scans-10min.mcap")
    settings = make_settings("paper", {"bins": str(BINS)})
    rows = []
    for kind, path in (("bag", as_bag(alone)), ("db3", as_database(alone))):

        def by_mpap(path: Path = path) -> object:
            return _by_mpap(path, settings)

        def by_rosbags(path: Path = path) -> object:
            return _by_rosbags(path)

        mine, rosbags = in_turns([by_mpap, by_rosbags], REPEATS)
        rows.append(
            Row(
                work=f"10 min of scans, {kind} -> 12-bin features",
                mpap=_ms(mine),
                beside="rosbags deserialize + vectorised numpy",
                peer=_ms(rosbags),
                unit="ms",
                goal=">=",
            )
        )
    return rows


def _ms(times: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(1000 * seconds for seconds in times)


def vectorised(ranges: F32, range_min: float = 0.02, range_max: float = 8.0) -> list[F32]:
    """Clean the ranges of many scans and take the five features of the paper."""
    cleaned = np.where(
        np.isfinite(ranges) & (ranges > 0) & (ranges <= range_max), ranges, range_max
    )
    cleaned = np.maximum(cleaned, range_min).astype(np.float32)
    n_beams = ranges.shape[1] // BINS * BINS
    bins = cleaned[:, :n_beams].reshape(len(ranges), BINS, -1)
    low, high = bins.min(axis=2), bins.max(axis=2)
    steps = np.abs(np.diff(bins, axis=2)).mean(axis=2)
    return [low, high, bins.mean(axis=2), high - low, steps]


def _by_mpap(path: Path, settings: Settings) -> list[Float32Array]:
    """Return embedded global differences, as learn takes them."""
    with open_log(path) as reader:
        roles = choose_roles(reader, TopicChoice())
        survey = survey_log(reader, roles, settings.scan.forward_rad())
        embedder = ScanEmbedder(settings.scan, survey.forward_rad, survey.range_max)
        return [
            embedder.transform(block).features
            for batch in Replay(reader, roles, settings.bumper)
            for block in batch.scans
        ]


def _by_rosbags(path: Path) -> F32:
    """Return embedded global differences of all scans at once."""
    with AnyReader([path]) as reader:
        scans: list[Any] = [
            reader.deserialize(raw, connection.msgtype)
            for connection, _, raw in reader.messages(connections=reader.connections)
        ]
    ranges = np.stack([scan.ranges for scan in scans])
    low, high = scans[0].range_min, scans[0].range_max
    cleaned = np.where(np.isfinite(ranges) & (ranges > 0) & (ranges <= high), ranges, high)
    bins = np.maximum(cleaned, low).reshape(len(ranges), BINS, -1)
    histograms = bins.max(axis=2) - bins.min(axis=2)
    mass = histograms.sum(axis=1, keepdims=True)
    shares = np.divide(histograms, mass, out=np.zeros_like(histograms), where=mass > 0)
    return np.concatenate([np.sqrt(shares), mass <= 0], axis=1, dtype=np.float32)


def _unpacked_bytes(path: Path) -> int:
    """Read a file, decompress its chunks and check their sums: the least there is to do."""
    content = memoryview(path.read_bytes())
    unpacker = zstandard.ZstdDecompressor()
    at, total = _MAGIC_BYTES, 0
    while at < len(content) - _MAGIC_BYTES:
        opcode, length = struct.unpack_from("<BQ", content, at)
        at += 9
        if opcode == _CHUNK:
            size, crc, name_length = struct.unpack_from("<QII", content, at + 16)
            packed = content[at + 40 + name_length : at + length]
            records = unpacker.decompress(packed, max_output_size=size)
            if zlib.crc32(records) != crc:
                msg = f"{path.name}: a checksum is wrong"
                raise ValueError(msg)
            total += len(records)
        at += length
    return total
