"""Tables of patches and images read back from CSV."""

from pathlib import Path

import numpy as np
import pytest

from mpap_cli.errors import LogError, UsageError
from mpap_cli.evaluation.patch_files import read_free_ahead, read_seen_patches, read_true_patches

STAMP = 1_700_000_000_123_456_789
SEEN = f"""log,log_index,stamp_ns,row,column,cluster,p_obstacle,unknown
a.bag,0,{STAMP},0,1,4,0.25,0
a.bag,0,{STAMP},5,0,,,1
b.bag,1,{STAMP + 1},2,3,0,1.0,0
"""
TRUE = f"""log,stamp_ns,row,column,floor,wall,obstacle
a.bag,{STAMP},0,1,0.5,0.25,0.25
"""


def written(folder: Path, text: str) -> Path:
    """Write a table."""
    path = folder / "table.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_predictions_of_one_log_are_read(tmp_path: Path) -> None:
    """Stamps keep their last digit; empty cells are no cluster and no probability."""
    path = written(tmp_path, SEEN)

    first, second = read_seen_patches(path, 0), read_seen_patches(path, 1)

    assert first.places.stamps_ns.tolist() == [STAMP, STAMP]
    assert (first.places.rows.tolist(), first.places.columns.tolist()) == ([0, 5], [1, 0])
    assert first.cluster.tolist() == [4, -1]
    assert first.p_obstacle[0] == 0.25
    assert np.isnan(first.p_obstacle[1])
    assert first.unknown.tolist() == [False, True]
    assert second.places.stamps_ns.tolist() == [STAMP + 1]


def test_truth_is_read(tmp_path: Path) -> None:
    """Shares of floor, wall and obstacle, patch by patch."""
    found = read_true_patches(written(tmp_path, TRUE))

    assert found.places.stamps_ns.tolist() == [STAMP]
    assert found.shares.tolist() == [[0.5, 0.25, 0.25]]


def test_free_way_is_read(tmp_path: Path) -> None:
    """Stamps and metres, image by image; other columns are not looked at."""
    path = written(tmp_path, f"log,stamp_ns,free_ahead_m\na,{STAMP},2.5\n")

    stamps_ns, free_m = read_free_ahead(path)

    assert (stamps_ns.tolist(), free_m.tolist()) == ([STAMP], [2.5])


def test_header_alone_is_an_empty_table(tmp_path: Path) -> None:
    """A log without images has no patch."""
    seen = read_seen_patches(written(tmp_path, SEEN.splitlines()[0] + "\n"), 0)
    truth = read_true_patches(written(tmp_path, TRUE.splitlines()[0] + "\n"))

    assert seen.cluster.size == 0
    assert truth.shares.shape == (0, 3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no stamp_ns, row, column, floor, wall, obstacle among no column"),
        ("log,stamp_ns,row\n", "no column, floor"),
        (TRUE + f"a.bag,{STAMP},0\n", "not a whole table"),
        (TRUE + "a.bag,soon,0,1,1,0,0\n", "not a whole table.*soon"),
        (TRUE + '"a.bag', "not a whole table"),
    ],
)
def test_table_that_is_none(tmp_path: Path, text: str, message: str) -> None:
    """One line names the file, what was found, and what to do."""
    with pytest.raises(UsageError, match=f"table.csv: {message}"):
        read_true_patches(written(tmp_path, text))


def test_table_that_cannot_be_read(tmp_path: Path) -> None:
    """A missing file and one in another encoding are our errors."""
    bad = tmp_path / "table.csv"
    bad.write_bytes(TRUE.encode("utf-16"))

    with pytest.raises(LogError, match="No such file"):
        read_free_ahead(tmp_path / "missing.csv")
    with pytest.raises(UsageError, match="UTF-8"):
        read_true_patches(bad)
