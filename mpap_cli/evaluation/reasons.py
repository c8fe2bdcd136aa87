"""Why an area is empty, in words."""

from mpap_cli.evaluation.roc import Scored
from mpap_cli.evaluation.sheets import Sheet

CIRCULAR = "the presses were made from the scan itself: scoring them by the scan is circular"


def why_empty(sheet: Sheet, target: str, scored: Scored, *, circular: bool) -> str:
    """Say why there is no area.

    Parameters
    ----------
    sheet : Sheet
        Scans with truth and folds.
    target : str
        As tables name it.
    scored : Scored
        What could be scored of them.
    circular : bool
        Whether the truth was made from the scan.
    """
    reasons = (
        (circular, CIRCULAR),
        (sheet.rows.n_scans == 0, "no scan could be used"),
        (not (sheet.truth == 1).any(), f"no positive scan for target {target}"),
        (not (sheet.truth == 0).any(), f"no negative scan for target {target}"),
        (sheet.folds.plan.reason != "", sheet.folds.plan.reason),
        (scored.score.size == 0, "no fold has both classes to learn from"),
    )
    return next((words for holds, words in reasons if holds), "no fold has both classes to score")
