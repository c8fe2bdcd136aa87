"""The run of a fleet: what is there already, what is learnt now, what is missing in the end."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field

from mpap_cli.commands.fleet.leaves import find_leaf, learn_leaf
from mpap_cli.commands.fleet.manifest import FAILED, PENDING, Manifest
from mpap_cli.commands.fleet.tasks import Leaf, LeafTask, Outcome
from mpap_cli.commands.fleet.workers import run_tasks
from mpap_cli.outputs.text_table import count

LOGGER = logging.getLogger(__name__)


@dataclass(slots=True)
class Fleet:
    """The logs of a run: leaves by number of the log, and what is missing.

    ``leaves`` hold each leaf once, under the first of the logs that are the same. What was
    odd about the logs in ``told`` was said in this process while they were learnt.
    """

    tasks: Sequence[LeafTask]
    manifest: Manifest
    leaves: dict[int, Leaf] = field(default_factory=dict)
    missing: dict[int, Outcome] = field(default_factory=dict)
    told: set[int] = field(default_factory=set)
    n_finished: int = 0

    def learn(self, jobs: int, scheduler: str | None) -> None:
        """Learn what is not there yet; every log that finishes is told and noted.

        Raises
        ------
        MpapError
            If no scheduler answers.
        """
        waiting = list[LeafTask]()
        for task in self.tasks:
            leaf = find_leaf(task, task.described) if task.described is not None else None
            if leaf is None:
                waiting.append(task)
            else:
                self._take(task, Outcome(leaf=leaf, reused=True))
        if self.n_finished:
            LOGGER.info("%s learnt before", count(self.n_finished, "log"))
        for task, outcome in run_tasks(learn_leaf, waiting, jobs, scheduler):
            if scheduler is None and jobs == 1 and not outcome.reused:
                self.told.add(task.number)
            self._take(task, self._checked(task, outcome))
            self._tell(task, outcome)
        self._drop_repeated()

    def _checked(self, task: LeafTask, outcome: Outcome) -> Outcome:
        """Return the outcome, or say that its leaf is not to be seen from here."""
        if outcome.leaf is None or find_leaf(task, outcome.leaf.log) is not None:
            return outcome
        reason = f"{task.name}: its leaf is not in {task.leaves}; workers must share that folder"
        return Outcome(reason=reason)

    def _take(self, task: LeafTask, outcome: Outcome) -> None:
        """Note how a log ended; with --strict a damaged one has failed."""
        if outcome.leaf is not None and outcome.leaf.facts.damaged and task.selection.strict:
            outcome = Outcome(reason=f"{task.name}: part of it is damaged (--strict)")
        self.n_finished += 1
        if outcome.leaf is not None:
            self.leaves[task.number] = outcome.leaf
            self.manifest.done(task.number, outcome.leaf)
        else:
            self.missing[task.number] = outcome
            state = PENDING if outcome.pending else FAILED
            self.manifest.missing(task.number, state, outcome.reason)

    def _tell(self, task: LeafTask, outcome: Outcome) -> None:
        """Say one line of a log that has just finished."""
        turn = f"({self.n_finished} of {len(self.tasks)})"
        if task.number in self.missing:
            LOGGER.warning("%s; left out %s", self.missing[task.number].reason, turn)
        elif outcome.leaf is not None:
            facts = outcome.leaf.facts
            presses = "no bumper" if facts.n_presses is None else count(facts.n_presses, "press")
            how = "learnt before" if outcome.reused else f"learnt in {facts.seconds:.1f} s"
            said = f"{count(facts.n_scans, 'scan')}, {presses}"
            LOGGER.info("%s: %s, %s %s", task.name, how, said, turn)

    def _drop_repeated(self) -> None:
        """Let each leaf count once, whichever of the same logs it is of."""
        first: dict[str, int] = {}
        for number in sorted(self.leaves, key=lambda one: str(self.tasks[one].path)):
            leaf = self.leaves[number]
            if leaf.folder.name in first:
                other = self.tasks[first[leaf.folder.name]].path
                del self.leaves[number]
                self.manifest.done(number, leaf, f"the same log as {other}")
                LOGGER.warning(
                    "%s: the same log as %s; learnt once", self.tasks[number].path, other
                )
            else:
                first[leaf.folder.name] = number
