"""The bench an experiment works at: what is asked of it, and where it puts what it finds."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from mpap_cli.commands.reproducing.request import ReproduceRequest
from mpap_cli.evaluation.reproduced import (
    ITEMS,
    Finding,
    Picture,
    ReproducedRow,
    Spread,
    spread,
)
from mpap_cli.logs.reader import LogPath
from mpap_cli.outputs.results_reader import InputFile, describe_input
from mpap_cli.params import Settings, make_settings

LOGGER = logging.getLogger(__name__)


@dataclass(slots=True)
class Found:
    """What one experiment found; ``inputs`` are files of the user that it read."""

    rows: list[ReproducedRow] = field(default_factory=list)
    pictures: list[Picture] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    inputs: list[InputFile] = field(default_factory=list)
    exit_code: int = 0


class Bench:
    """Request and folders of one experiment, and the notebook it writes into.

    Parameters
    ----------
    experiment : str
        Name, the first column of reproduced.csv.
    request : ReproduceRequest
        What the user asked for.
    wanted : frozenset of str
        Keys of ``ITEMS`` that this experiment is to deliver.
    figures : Path
        Folder of the pictures.
    scratch : Path
        Folder of its own for logs and other files that are thrown away.
    """

    def __init__(
        self,
        experiment: str,
        request: ReproduceRequest,
        wanted: frozenset[str],
        figures: Path,
        scratch: Path,
    ) -> None:
        self.experiment = experiment
        self.request = request
        self.scratch = scratch
        self.found = Found()
        self._wanted = wanted
        self._figures = figures

    @property
    def seeds(self) -> range:
        """Seeds of the repeats, the first of them for what is made once."""
        n_seeds = 1 if self.request.short else self.request.seeds
        return range(self.request.seed, self.request.seed + n_seeds)

    @property
    def short(self) -> bool:
        """Whether everything is to be small."""
        return self.request.short

    def wants(self, *items: str) -> bool:
        """Tell whether any of these items is to be delivered."""
        return not self._wanted.isdisjoint(items)

    def settings(self, profile: str, **values: object) -> Settings:
        """Return settings of a profile with the seed of the request; ``min_points=5`` as words."""
        texts = {key.replace("_", "-"): str(value) for key, value in values.items()}
        return make_settings(profile, {"seed": str(self.request.seed), **texts})

    def number(  # noqa: PLR0913  # a cell, and what is to be known of it
        self,
        item: str,
        row: str,
        quantity: str,
        ours: float | Sequence[float | None] | None,
        *,
        paper: float | None = None,
        part: str = "",
        note: str = "",
    ) -> Spread:
        """Write one number down.

        Parameters
        ----------
        item : str
            Key of ``ITEMS``; nothing is written if it is not wanted.
        row, quantity : str
            Line and column of the table it stands in.
        ours : float, sequence of float, or None
            One value, or those of the repeats.
        paper : float, optional
            What the paper prints.
        part : str
            Name of the table among several of an item.
        note : str
            What else is to be known; the same words are printed once under the table.

        Returns
        -------
        Spread
            Mean and spread, for findings.
        """
        repeats = [ours] if ours is None or isinstance(ours, (int, float)) else list(ours)
        found = spread(repeats)
        made = _row(row, quantity, paper, note)
        made = replace(made, ours=found.mean, sd=found.sd, n=found.n)
        self._keep(item, part, made)
        return found

    def duration(  # noqa: PLR0913  # as number
        self,
        item: str,
        row: str,
        quantity: str,
        seconds: float | Sequence[float],
        *,
        paper: float | None = None,
        part: str = "",
        note: str = "",
    ) -> float:
        """Write a duration down, CPU time by custom; return the mean of the repeats."""
        repeats = [seconds] if isinstance(seconds, (int, float)) else seconds
        mean = sum(repeats) / len(repeats)
        made = replace(_row(row, quantity, paper, note), n=len(repeats), seconds=mean)
        self._keep(item, part, made)
        return mean

    def _keep(self, item: str, part: str, row: ReproducedRow) -> None:
        """Append a row under the name of its table, if it is wanted."""
        if self.wants(item):
            title = ITEMS[item].title
            name = f"{title}, {part}" if part else title
            self.found.rows.append(replace(row, experiment=self.experiment, item=name))

    def picture(self, item: str, caption: str, variant: str = "") -> Path:
        """Return where to write a figure (``figure-08.png``), and list it with its caption.

        ``variant`` tells several pictures of one figure apart (``figure-10-held-out.png``).
        """
        kind, number = item.split("-")
        name = f"{kind}-{int(number):02d}{'-' + variant if variant else ''}.png"
        self.found.pictures.append(Picture(item, name, caption))
        return self._figures / name

    def finding(self, item: str, words: str) -> None:
        """Write down a sentence made of the numbers of this run, if its item is wanted."""
        if self.wants(item):
            self.found.findings.append(Finding(item, words))

    def read(self, path: LogPath) -> None:
        """Note a file of the user that the results depend on."""
        self.found.inputs.append(describe_input(path))

    def left_out(self, exit_code: int) -> None:
        """Note that part of the user's input was damaged (exit code 3)."""
        self.found.exit_code = max(self.found.exit_code, exit_code)

    def tell(self, words: str) -> None:
        """Say on stderr how far the experiment is."""
        LOGGER.info("%s: %s", self.experiment, words)


def _row(row: str, quantity: str, paper: float | None, note: str) -> ReproducedRow:
    """Return a number that is not there yet."""
    return ReproducedRow(
        experiment="",
        item="",
        row=row,
        quantity=quantity,
        paper=paper,
        ours=None,
        sd=None,
        n=None,
        seconds=None,
        note=note,
    )
