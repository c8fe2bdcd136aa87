"""The camera fixtures, and what the commands write of images."""

from tests.commands.running import FIXTURES

CAMERA_A, CAMERA_B = FIXTURES / "camera-a.mcap", FIXTURES / "camera-b.mcap"
SMALL = ("--set", "reservoir=100")

DECISION_COLUMNS = (
    "log log_index time_s stamp_ns action obstacle_patches unknown_patches nearest_ahead_m"
)
PATCH_COLUMNS = "log log_index stamp_ns row column cluster p_obstacle unknown"
NOVELTY_COLUMNS = (
    "log log_index sensor window_start_s window_end_s start_stamp_ns observations novel "
    "percent_novel percent_unknown_at_start clusters"
)
