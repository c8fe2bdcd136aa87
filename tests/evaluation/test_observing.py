"""Scans are read once and looked at in every way asked for."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest

from mpap_cli.evaluation.observing import Look, observe, raw_look
from mpap_cli.features.scans.scan_features import ScanEmbedder
from mpap_cli.observations import ObservedLog, ScanBlock
from mpap_cli.params import ScanParams, Settings

MakeLog = Callable[..., ObservedLog]


def test_each_log_is_read_once_for_all_looks(make_log: MakeLog) -> None:
    """Three ways to look at two logs are one pass over each."""
    read = []
    logs = [make_log(f"log{i}", 2, i) for i in range(2)]

    def counted(log: ObservedLog) -> ObservedLog:
        def blocks() -> Iterator[ScanBlock]:
            read.append(log.name)
            return log.blocks()

        return replace(log, blocks=blocks)

    six = ScanParams(feature="min-value", bins=6)
    found = observe([counted(log) for log in logs], [Look(ScanParams()), Look(six), raw_look(six)])

    assert read == ["log0", "log1"]
    assert len(found) == 3
    assert all(rows.n_scans == 300 for rows in found.values())


def test_rows_are_those_of_the_embedder(make_log: MakeLog, settings: Settings) -> None:
    """Features equal those of each log by itself: nothing looks back beyond its start."""
    logs = [make_log(f"log{i}", 2, i) for i in range(2)]
    look = Look(settings.scan)

    rows = observe(logs, [look])[look]

    for index, log in enumerate(logs):
        embedder = ScanEmbedder(settings.scan, log.forward_rad, log.range_max)
        alone = [embedder.transform(block) for block in log.blocks()]
        inside = rows.log_index == index
        assert np.array_equal(
            rows.features[inside], np.concatenate([block.features for block in alone])
        )
        assert np.array_equal(
            rows.stamps_ns[inside], np.concatenate([block.stamps_ns for block in alone])
        )


def test_raw_bins_are_metres_of_twelve_sectors(make_log: MakeLog, settings: Settings) -> None:
    """The sectors ahead see the wall at 3 m, those behind 4 m."""
    look = raw_look(settings.scan)

    rows = observe([make_log()], [look])[look]

    assert rows.features.shape == (300, 12)
    assert rows.features[0, 5:7] == pytest.approx(3.0, abs=0.15)
    assert rows.features[0, 0] == pytest.approx(4.0, abs=0.15)


def test_no_log_and_no_scan_give_empty_rows(make_log: MakeLog, settings: Settings) -> None:
    """Empty rows keep their width."""
    silent = replace(make_log(), blocks=lambda: iter(()))
    look = Look(settings.scan)

    rows = observe([silent], [look])[look]

    assert rows.n_scans == 0
    assert rows.features.shape == (0, ScanEmbedder(settings.scan).n_dims)


def test_block_takes_a_mask_or_rows(make_log: MakeLog, settings: Settings) -> None:
    """Both ways to choose scans give the same block."""
    look = Look(settings.scan)
    rows = observe([make_log()], [look])[look]
    mask = np.arange(300) % 7 == 0

    by_mask, by_rows = rows.block(mask), rows.block(np.flatnonzero(mask))

    assert np.array_equal(by_mask.features, by_rows.features)
    assert np.array_equal(by_mask.kept, by_rows.kept)
