"""What ``predict`` is asked for beside logs and topics."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictRequest:
    """Which model predicts, from which probability a collision is announced, and where to.

    ``patch_threshold`` is the probability from which a patch is an obstacle (None: the
    model's setting); with ``to_mcap`` the predictions are also written as logs.
    """

    out: Path
    model: Path
    threshold: float = 0.2
    patch_threshold: float | None = None
    to_mcap: bool = False
    jobs: int = 2
