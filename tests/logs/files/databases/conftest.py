"""A database of rosbag2 to be broken."""

from pathlib import Path

import pytest

from tests.logs.files.databases.broken_rows import ROWS
from tests.logs.rows import WriteLog


@pytest.fixture
def database(write_log: WriteLog) -> Path:
    """Return a database of a few hundred pages."""
    return write_log("sqlite3", ROWS) / "log.db3"
