"""Truth and prediction over time (figure 9)."""

from mpap_cli.commands.evaluating.outputs import timelines_of
from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.laser_logs import PLACES, scenes
from mpap_cli.evaluation.paper_tables import COLLISION_THRESHOLD
from mpap_cli.evaluation.scoring import Variant, evaluate_all
from mpap_cli.evaluation.timelines import Timeline
from mpap_cli.outputs.plots import plot_timeline

_FEATURE, _BINS = "global-diff", 6
_PROTOCOLS = {
    "prequential": "predicted before it is learnt",
    "in-sample": "predicted by a model of all scans",
}


def draw_course(bench: Bench) -> None:
    """Draw the first indoor scene, each scan predicted before it is learnt."""
    place = PLACES[0]
    settings = bench.settings("paper", feature=_FEATURE, bins=_BINS)
    for scene in scenes(bench, place, settings, n=1):
        for protocol, words in _PROTOCOLS.items():
            question = scene.question(protocol, COLLISION_THRESHOLD)
            variants = [Variant("mpap", settings)]
            timeline = evaluate_all(question, variants, baselines=False).timeline
            _write_summary(bench, f"each scan {words}", timeline)
            if protocol == "prequential":
                caption = (
                    f"Truth and prediction over time: {place}, {_FEATURE}, {_BINS} bins, threshold "
                    f"{COLLISION_THRESHOLD:g}, each scan {words}."
                )
                path = bench.picture("figure-9", caption)
                plot_timeline(path, timelines_of(timeline), COLLISION_THRESHOLD)


def _write_summary(bench: Bench, row: str, timeline: Timeline) -> None:
    """Write how the contacts were announced."""
    found = timeline.summary
    for quantity, value in (
        ("contacts", found.judged),
        ("announced", found.announced),
        ("median lead (s)", found.median_lead_s),
        ("false alarms a minute", found.false_alarms_per_min),
    ):
        bench.number("figure-9", row, quantity, value)
