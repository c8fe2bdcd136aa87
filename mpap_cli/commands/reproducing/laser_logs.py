"""The laser logs of section 5.2: simulated, a world for each seed, or those the user names."""

from collections.abc import Iterator
from dataclasses import dataclass

from mpap_cli.commands.evaluating.observed import observe_logs
from mpap_cli.commands.inputs.progress import no_progress
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.evaluation.sheets import Question
from mpap_cli.observations import ObservedLog, Press
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.params import Settings
from mpap_cli.properties.press_files import presses_from_csv, presses_of_log, rows_of_logs
from mpap_cli.simulation.scenario import simulate
from mpap_cli.simulation.settings import SimulationParams

PLACES = ("indoor", "outdoor")
TRUTH = "simulation"
_DURATION_S, _SHORT_S = 600.0, 120.0


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Logs that are one history: of one simulated world, or all that the user names.

    ``truth`` holds the contacts that are scored, None where those of the bumper are.
    """

    logs: tuple[ObservedLog, ...]
    truth: tuple[tuple[Press, ...], ...] | None

    def question(self, protocol: str | None, threshold: float = 0.2) -> Question:
        """Ask for contacts by a protocol, None for the best that the logs allow."""
        if self.truth is None:
            kinds = sorted({log.bump_source.partition(" ")[0] for log in self.logs} - {"none"})
            words = "+".join(kinds) or "none"
        else:
            words = TRUTH
        return Question(
            logs=self.logs,
            protocol=protocol,
            threshold=threshold,
            truth=self.truth,
            truth_name=words,
        )


def user_logs(bench: Bench, place: str) -> tuple[str, ...]:
    """Return the logs that the user names for a place; none: they are simulated."""
    return {"indoor": bench.request.indoor, "outdoor": bench.request.outdoor}[place]


def scenes(bench: Bench, place: str, settings: Settings, n: int | None = None) -> Iterator[Scene]:
    """Yield one scene after the other; each can be read until the next is asked for.

    Parameters
    ----------
    bench : Bench
        Seeds and logs of the user.
    place : str
        One of ``PLACES``.
    settings : Settings
        How bumps become presses, where forward is.
    n : int, optional
        Only the first so many worlds.

    Yields
    ------
    Scene
        One for each seed, scored against the contacts of the simulation, as the paper
        scores against labels by hand; or a single one of the logs that the user names.
    """
    words = user_logs(bench, place)
    if words:
        selection = LogSelection(logs=words)
        with ResultsFolder(bench.scratch, place) as results:
            observed = observe_logs(selection, settings, results, 1, no_progress)
            bench.found.inputs.extend(observed.inputs)
            bench.left_out(observed.exit_code)
            yield Scene(observed.logs, None)
        return
    for seed in bench.seeds[:n]:
        yield from _simulated(bench, place, settings, seed)


def _simulated(bench: Bench, place: str, settings: Settings, seed: int) -> Iterator[Scene]:
    """Yield the scene of one world, and remove its log afterwards."""
    log = bench.scratch / f"{place}-{seed}.mcap"
    params = SimulationParams(
        world=place, duration_s=_SHORT_S if bench.short else _DURATION_S, seed=seed
    )
    written = simulate(log, params)
    selection = LogSelection(logs=(str(log),))
    with ResultsFolder(bench.scratch, place) as results:
        (observed,) = observe_logs(selection, settings, results, 1, no_progress).logs
        rows = rows_of_logs(presses_from_csv(written.truth_path), [log.name], "truth")
        contacts = rows.get(log.name, ())
        yield Scene((observed,), (presses_of_log(contacts, 0, observed.start_ns, observed.end_ns),))
    log.unlink()
    written.truth_path.unlink()
