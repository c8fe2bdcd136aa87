"""What ``mpap similar`` prints: moments, the most similar first."""

from mpap_cli.commands.similar import Similar
from mpap_cli.observations import NS_PER_S
from mpap_cli.outputs.text_table import aligned, count, printable


def similar_text(found: Similar) -> str:
    """Lay out the moments found."""
    at_s = (found.seen.stamp_ns - found.seen.start_ns) / NS_PER_S
    seen = f"{found.seen.log}@{at_s:.1f}"
    lines = [f"{count(len(found.rows), 'moment')} like the {found.sensor} at {printable(seen)}"]
    cells = [("moment", "cluster", "distance")]
    for row in found.rows:
        cluster = "-" if row.cluster is None else str(row.cluster)
        cells.append((f"{row.log}@{row.time_s:.1f}", cluster, f"{row.distance:.3f}"))
    lines += aligned(cells, right={1, 2})
    lines.append(f"results: {printable(str(found.folder))}")
    return "".join(f"{line}\n" for line in lines)
