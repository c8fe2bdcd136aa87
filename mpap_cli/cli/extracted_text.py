"""What ``mpap extract`` prints: the segments with their sizes, and where they lie."""

from mpap_cli.commands.extract import Extracted
from mpap_cli.outputs.text_table import aligned, count, printable

SHOWN_SEGMENTS = 30
_MEGA = 1e6


def extracted_text(found: Extracted) -> str:
    """Lay out what was cut: one line a segment, the first ones."""
    share = 100 * found.kept_s / found.duration_s if found.duration_s else 0.0
    n_messages = sum(row.messages for row in found.rows)
    megabytes = sum(row.bytes for row in found.rows) / _MEGA
    summary = (
        f"{count(len(found.rows), 'segment')} of {count(found.n_logs, 'log')}: "
        f"{found.kept_s:.1f} s of {found.duration_s:.1f} s ({share:.1f} %), "
        f"{count(n_messages, 'message')}, {megabytes:.1f} MB"
    )
    lines = [summary]
    if found.rows:
        cells = [("log", "start", "end", "reason", "score", "messages", "MB")]
        cells += [
            (
                row.log,
                f"{row.start_s:.1f}",
                f"{row.end_s:.1f}",
                row.reason,
                f"{row.score:.3g}",
                f"{row.messages:,}",
                f"{row.bytes / _MEGA:.2f}",
            )
            for row in found.rows[:SHOWN_SEGMENTS]
        ]
        lines += aligned(cells, right={1, 2, 4, 5, 6})
    if len(found.rows) > SHOWN_SEGMENTS:
        lines.append(f"and {len(found.rows) - SHOWN_SEGMENTS:,} more in segments.csv")
    if found.folder is None:
        lines.append("dry run: nothing is written")
    else:
        lines.append(f"results: {printable(str(found.folder))}")
    return "".join(f"{line}\n" for line in lines)
