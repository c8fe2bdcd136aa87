"""Collision prediction from laser scans (section 5.2): table 4, figures 9 to 11."""

from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.laser_course import draw_course
from mpap_cli.commands.reproducing.laser_curves import draw_curves
from mpap_cli.commands.reproducing.laser_examples import draw_examples
from mpap_cli.commands.reproducing.laser_findings import tell_findings
from mpap_cli.commands.reproducing.laser_logs import PLACES
from mpap_cli.commands.reproducing.laser_marks import mark_place
from mpap_cli.commands.reproducing.laser_tables import write_tables


def run(bench: Bench) -> None:
    """Deliver table 4 and figures 9 to 11."""
    if bench.wants("table-4", "figure-10"):
        marks = {place: mark_place(bench, place) for place in PLACES}
        write_tables(bench, marks)
        tell_findings(bench, marks)
        if bench.wants("figure-10"):
            draw_curves(bench, marks)
    if bench.wants("figure-9"):
        draw_course(bench)
    if bench.wants("figure-11"):
        draw_examples(bench)
