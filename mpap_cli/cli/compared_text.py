"""What ``mpap compare`` prints: a matrix of unknown shares."""

from mpap_cli.commands.compare import NOVEL, Compared
from mpap_cli.evaluation.comparing import THE_OTHERS
from mpap_cli.outputs.text_table import aligned, count, printable


def compared_text(found: Compared) -> str:
    """Lay out how much of each log is unknown to each other one, and to all others."""
    n_logs = len(found.names)
    what = "patches" if found.sensor == "image" else "scans"
    shares = {
        (row.log_index, row.against_index): f"{row.percent_unknown:.1f} %" for row in found.rows
    }
    lines = [
        f"{count(n_logs, 'log')}: {what} of each that what was learnt of another leaves unknown"
    ]
    cells = [("log", *(f"to {index}" for index in range(n_logs)), f"to {THE_OTHERS}")]
    for index, name in enumerate(found.names):
        parts = [shares.get((index, other), "-") for other in [*range(n_logs), None]]
        cells.append((f"{index} {name}", *parts))
    lines += aligned(cells, right=set(range(1, n_logs + 2)))
    if found.exit_code == NOVEL:
        share = f"{100 * found.last_share:.1f} %"
        lines.append(f"{printable(found.names[-1])}: {share} is new, more than was allowed")
    lines.append(f"results: {printable(str(found.folder))}")
    return "".join(f"{line}\n" for line in lines)
