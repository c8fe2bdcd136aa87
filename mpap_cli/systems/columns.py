"""Columns that several tables share, each with its type and meaning.

What stands behind a type is the meaning of a column; docs/columns.md is made of it.
"""

from typing import Annotated

LogName = Annotated[str, "base name of the log"]
LogIndex = Annotated[int, "number of the log in the order given, from 0"]
TimeS = Annotated[float, "seconds since the first message of the log"]
StampNs = Annotated[
    int, "the same in nanoseconds: time of recording, with `--time-source header` the message's"
]
Sensor = Annotated[str, "`scan` or `image`"]
Method = Annotated[str, "`mpap` or the name of a baseline"]
Feature = Annotated[str | None, "value of a bin of a scan (setting `feature`)"]
Bins = Annotated[int | None, "number of bins of a scan (setting `bins`)"]
Profile = Annotated[str | None, "`robust` or `paper`"]
Target = Annotated[str, "what is to be foreseen: `contact`, `onset` or `early:S`"]
Protocol = Annotated[str, "which scans the scoring model had seen, see numbers.md"]
Truth = Annotated[str, "where the presses that are scored against come from"]
Cluster = Annotated[int | None, "number of the nearest cluster in clusters.csv"]
Presses = Annotated[int, "presses that are scored"]
VisiblePresses = Annotated[int, "those before which something near was seen ahead"]
