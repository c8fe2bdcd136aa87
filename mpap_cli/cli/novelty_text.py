"""What ``mpap novelty`` prints: log by log what was new, and the windows."""

from mpap_cli.commands.novelty import Novelty
from mpap_cli.outputs.console import shown
from mpap_cli.outputs.text_table import aligned, count, printable

SHOWN_WINDOWS = 12


def novelty_text(found: Novelty) -> str:
    """Lay out what was new: one line a log with its first windows behind it."""
    n_observations = sum(row.observations for row in found.rows)
    what = "patch" if found.sensor == "image" else "scan"
    n_windows = count(len(found.rows), "window")
    n_logs = count(len(found.boundaries), "log")
    lines = [f"{count(n_observations, what)} in {n_windows}, {n_logs}"]
    cells = [("log", "unknown at its start", "new as learnt, % by window")]
    for boundary in found.boundaries:
        shares = [
            f"{row.percent_novel:.0f}" for row in found.rows if row.log_index == boundary.log_index
        ]
        more = " ..." if len(shares) > SHOWN_WINDOWS else ""
        unknown = boundary.percent_unknown_at_start
        cells.append(
            (
                boundary.log,
                "-" if unknown is None else f"{unknown:.1f} %",
                " ".join(shares[:SHOWN_WINDOWS]) + more,
            )
        )
    lines += aligned(cells, right={1})
    lines += [
        f"{boundary.log}: {shown(boundary.ratio)} times as new as the windows before it"
        for boundary in found.boundaries
        if boundary.ratio is not None
    ]
    lines.append(f"results: {printable(str(found.folder))}")
    return "".join(f"{line}\n" for line in lines)
