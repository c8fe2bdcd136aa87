"""Which experiments there are, and on what they run here (table 1)."""

from collections.abc import Sequence

from mpap_cli.commands.reproducing.bench import Bench


def run(bench: Bench) -> None:
    """Deliver table 1, which has no numbers: the data of this run, section by section."""
    request = bench.request
    patches = "patches as given" if request.textures else "procedural image patches"
    bench.finding(
        "table-1",
        f"Here: section 5.1.1 on {patches}; 5.1.2 on ten random Gaussians in the plane and on "
        f"simulated camera runs; 5.2 indoor on {_logs(request.indoor)}, outdoor on "
        f"{_logs(request.outdoor)}; 5.3 on simulated camera runs with a bumper"
        f"{', novelty on logs as given' if request.novelty else ''}.",
    )


def _logs(given: Sequence[str]) -> str:
    """Say where the laser logs of a place come from."""
    return "logs as given" if given else "simulated laser logs"
