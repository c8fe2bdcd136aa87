"""Logs damaged at random places, judged by a scan that knows the undamaged ones."""

from pathlib import Path

import pytest

from benchmarks.measuring.guarded import Limits, guarded
from benchmarks.robustness.damage import DAMAGES, Tally, damage_log, read_copy, subject_of
from benchmarks.robustness.damaged_logs import KINDS, write_logs

CASES = 5


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Return one drive in every container."""
    return {log.name: log for log in write_logs(tmp_path_factory.mktemp("logs"), 6.0)}


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("kind", KINDS)
def test_all_that_is_whole_is_used(
    logs: dict[str, Path], tmp_path: Path, kind: str, damage: str
) -> None:
    """No crash, no hang, nothing wrong where a checksum tells, nothing lost in silence."""
    subject = subject_of(logs[kind])
    read_copy(logs[kind])

    tally = damage_log(subject, damage, CASES, 11, tmp_path, Limits())

    assert tally.is_clean, tally.notes
    assert tally.cases == CASES
    assert tally.mpap >= tally.scan
    assert tally.scan > 0 or damage == "cut"
    assert tally.largest_mb < 100


@pytest.mark.parametrize("kind", KINDS)
def test_scan_finds_every_message_of_the_undamaged_log(logs: dict[str, Path], kind: str) -> None:
    """Otherwise it would judge too mildly."""
    subject = subject_of(logs[kind])

    read = read_copy(logs[kind])

    assert read.keys == subject.held
    assert read.keys.total() > 100


def test_what_falls_short_is_counted() -> None:
    """A tally with any fault is not clean."""
    clean = Tally("none.bag", "cut", cases=1, scan=2, mpap=2, unchecked=3)

    faults = [
        Tally("none.bag", "cut", short=1),
        Tally("none.bag", "cut", crashes=1),
        Tally("none.bag", "cut", hangs=1),
        Tally("none.bag", "cut", wrong=1),
        Tally("none.bag", "cut", unsaid=1),
    ]

    assert clean.is_clean
    assert not any(tally.is_clean for tally in faults)


def _spin() -> None:
    while True:
        pass


def test_child_that_hangs_or_crashes_is_told() -> None:
    """By its time, its exception, or the memory that it asked for."""
    late = guarded(_spin, Limits(seconds=0.1))
    broken = guarded(lambda: 1 // 0, Limits())
    hungry = guarded(lambda: len(bytearray(1 << 28)), Limits(memory_mb=100))
    # larger than what malloc may have at hand
    good = guarded(lambda: len(bytearray(1 << 27)), Limits())

    assert late.is_late
    assert "ZeroDivisionError" in broken.crash
    assert "MemoryError" in hungry.crash
    assert (good.result, good.crash) == (1 << 27, "")
    assert 120 < good.grown_mb < 160
