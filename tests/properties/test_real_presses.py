"""Presses of real logs, as their table lists them."""

import os
from pathlib import Path

import numpy as np
import pytest

from mpap_cli.logs.reader import open_log
from mpap_cli.logs.replay import Replay
from mpap_cli.logs.topics import choose_roles
from mpap_cli.params import BumperParams
from mpap_cli.properties.labels import label_contact
from mpap_cli.properties.presses import PressTracker

LOGS = {
    "real/neato-2018-a1.bag": (6, 45),
    "real/neato-2018-a2.bag": (2, 11),
    "real/neato-2018-a3.bag": (2, 2),
    "real/neato-2018-a4.bag": (1, 26),
    "real/neato-2018-b1.bag": (1, 41),
    "real/neato-2018-c1.bag": (1, 39),
    "real/neato-2023-d1": (1, 11),
    "real/neato-2023-d2": (1, 1),
    "real/neato-2024-e1": (2, 3),
    "real/neato-2024-e2": (1, 7),
    "real/neato-2024-e3": (0, 0),
    "gazebo/gazebo-f1": (1, 12),
    "gazebo/gazebo-g1.bag": (4, 23),
    "gazebo/gazebo-g2.bag": (2, 2),
    "gazebo/gazebo-h1": (4, 20),
    "converted/neato-2024-e1.mcap": (2, 3),
    "converted/neato-2018-a2-json.mcap": (2, 11),
}


@pytest.mark.shared
@pytest.mark.skipif("MPAP_SHARED" not in os.environ, reason="MPAP_SHARED names no logs")
@pytest.mark.parametrize(("log", "counts"), LOGS.items())
def test_a_real_log_has_its_presses(log: str, counts: tuple[int, int]) -> None:
    """Number of presses, and of scans while pressed."""
    path = Path(os.environ["MPAP_SHARED"]) / "data" / "logs" / log
    with open_log(path) as reader:
        replay = Replay(reader, choose_roles(reader), BumperParams())
        assert replay.bump_kind is not None
        tracker = PressTracker(replay.bump_kind, BumperParams(), replay.hold_s)
        stamps_ns = [np.empty(0, dtype=np.int64)]

        for batch in replay:
            tracker.add(batch.bumps)
            stamps_ns += [block.stamps_ns for block in batch.scans]
        tracker.end(replay.end_ns)

    pressed = label_contact(np.concatenate(stamps_ns), tracker.presses)
    assert (len(tracker.presses), int(pressed.sum())) == counts
