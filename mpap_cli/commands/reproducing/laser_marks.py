"""Every feature and number of bins scored on the laser logs of a place (section 5.2)."""

from collections.abc import Callable
from dataclasses import dataclass

from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.laser_logs import Scene, scenes, user_logs
from mpap_cli.commands.reproducing.laser_returns import lost_shares
from mpap_cli.evaluation.marks import Marks
from mpap_cli.evaluation.scoring import Variant, evaluate_all
from mpap_cli.params import PAPER_FEATURES

BINS = (6, 12)
ROBUST = "mpap, profile robust"
Key = tuple[str, int]
"""Feature and number of bins."""

KEYS: tuple[Key, ...] = tuple((feature, bins) for feature in PAPER_FEATURES for bins in BINS)
_HELD_OUT = "blocked"


@dataclass(frozen=True, slots=True, eq=False)
class SceneMarks:
    """What one scene gave.

    The paper's features learnt and scored on the same scans, and held out; the other methods
    held out; ``lost`` percent of the beams without return in contact, and otherwise.
    """

    in_sample: dict[Key, Marks]
    held_out: dict[Key, Marks]
    others: dict[str, Marks]
    lost: tuple[float | None, float | None]


@dataclass(frozen=True, slots=True, eq=False)
class PlaceMarks:
    """All scenes of a place."""

    place: str
    scenes: list[SceneMarks]

    def areas(self, chosen: Callable[[SceneMarks], Marks]) -> list[float | None]:
        """Return the area of one method, scene by scene."""
        return [chosen(one).row.auc for one in self.scenes]


def mark_place(bench: Bench, place: str) -> PlaceMarks:
    """Score the logs of a place.

    Parameters
    ----------
    bench : Bench
        Logs and seeds.
    place : str
        Indoor or outdoor.
    """
    # simulated worlds are repeated: their spread stands for the interval inside of one
    resamples = {} if user_logs(bench, place) else {"resamples": 10}
    variants = [
        Variant("mpap", bench.settings("paper", feature=feature, bins=bins, **resamples))
        for feature, bins in KEYS
    ]
    robust = Variant(ROBUST, bench.settings("robust", **resamples))
    marked: list[SceneMarks] = []
    for scene in scenes(bench, place, variants[0].settings):
        marked.append(_mark_scene(scene, variants, robust))
        bench.tell(f"{', '.join(log.name for log in scene.logs)} scored")
    return PlaceMarks(place, marked)


def _mark_scene(scene: Scene, variants: list[Variant], robust: Variant) -> SceneMarks:
    """Score every setting on one scene; the held-out protocol is blocks of time, or logs."""
    held_out = scene.question(_HELD_OUT if len(scene.logs) == 1 else None)
    seen = evaluate_all(scene.question("in-sample"), variants, baselines=False)
    unseen = evaluate_all(held_out, variants, baselines=False)
    others = evaluate_all(held_out, [robust])
    return SceneMarks(
        in_sample=dict(zip(KEYS, seen.marks, strict=True)),
        held_out=dict(zip(KEYS, unseen.marks, strict=True)),
        others={one.row.method: one for one in others.marks},
        lost=lost_shares(scene),
    )
