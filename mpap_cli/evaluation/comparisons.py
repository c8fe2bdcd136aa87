"""What each baseline says of every scan, fitted on the training scans of its fold."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mpap_cli.evaluation.baselines import (
    BASELINES,
    ReadOut,
    nearest_score,
    training_sample,
)
from mpap_cli.evaluation.marks import Asked, Marks, Name, Outcome, mark
from mpap_cli.evaluation.observing import RAW_BINS, RAW_FEATURE
from mpap_cli.evaluation.sheets import Sheet, has_both_labels
from mpap_cli.observations import BoolArray, FloatArray, Int8Array
from mpap_cli.params import Settings
from mpap_cli.properties.labels import NO_LABEL


@dataclass(frozen=True, slots=True, eq=False)
class Sheets:
    """The same logs as baselines look at them: embedded ``features``, and ``raw`` bins."""

    features: Sheet
    raw: Sheet

    def of(self, name: str) -> Sheet:
        """Return the sheet that a baseline looks at."""
        return self.raw if BASELINES[name].rows in {"raw", "nearest-1s"} else self.features


@dataclass(frozen=True, slots=True, eq=False)
class Fitting:
    """One fit: rows (m, d) and labels (m,) to fit on, and which scans (n,) to score."""

    rows: FloatArray
    labels: Int8Array
    test: BoolArray


def compare(name: str, sheet: Sheet, fittings: Iterator[Fitting], read_out: ReadOut) -> Outcome:
    """Score scans by a baseline, each by the fit that tests it.

    Parameters
    ----------
    name : str
        A key of ``BASELINES``.
    sheet : Sheet
        n scans, of the plain bins or of the features as the baseline needs them.
    fittings : iterator of Fitting
        From :func:`held_out_fits`, :func:`in_sample_fit` or :func:`given_fit`.
    read_out : ReadOut
        Kernel and seed.

    Returns
    -------
    Outcome
        NaN where the labels of the fit are of one class; a nearest range needs no fit
        and keeps its score even there.
    """
    baseline = BASELINES[name]
    looked_at = rows_for(name, sheet)
    found = Outcome.nothing(sheet.rows.n_scans)
    if baseline.is_range:
        found.score[:] = nearest_score(looked_at)
    for fitting in fittings:
        usable = fitting.labels != NO_LABEL
        if fitting.test.any() and has_both_labels(fitting.labels):
            rows, labels = fitting.rows[usable], fitting.labels[usable] == 1
            sample = training_sample(labels, read_out.seed)
            fitted = baseline.fit(rows[sample], labels[sample], read_out)
            found.score[fitting.test], found.p[fitting.test] = fitted(looked_at[fitting.test])
    return found


def rows_for(name: str, sheet: Sheet) -> FloatArray:
    """Return what a baseline looks at: (n, 1) nearest ranges, or the rows of the sheet."""
    if BASELINES[name].rows == "nearest":
        return sheet.rows.nearest_ahead_m[:, None]
    if BASELINES[name].rows == "nearest-1s":
        nearest: FloatArray = sheet.rows.features.min(axis=1, keepdims=True)
        return nearest
    return sheet.rows.features


def held_out_fits(name: str, sheet: Sheet, pair: int) -> Iterator[Fitting]:
    """Fit on what the model of each fold learns from."""
    looked_at = rows_for(name, sheet)
    for fold in range(sheet.folds.plan.n_folds):
        learnt = sheet.folds.train(fold)
        yield Fitting(looked_at[learnt], sheet.labels[learnt, pair], sheet.test(fold))


def in_sample_fit(name: str, sheet: Sheet, pair: int) -> Iterator[Fitting]:
    """Fit on all scans, and score them."""
    everything = np.ones(sheet.rows.n_scans, dtype=np.bool_)
    yield Fitting(rows_for(name, sheet), sheet.labels[:, pair], everything)


def given_fit(name: str, sheet: Sheet, learnt: Sheet, pair: int) -> Iterator[Fitting]:
    """Fit on the logs of a given model, ``learnt``, and score all scans of the sheet."""
    everything = np.ones(sheet.rows.n_scans, dtype=np.bool_)
    yield Fitting(rows_for(name, learnt), learnt.labels[:, pair], everything)


def score_baselines(
    sheets: Sheets, learnt: Sheets | None, settings: Settings, asked: Asked, read_out: ReadOut
) -> Iterator[Marks]:
    """Fit and mark every baseline.

    Parameters
    ----------
    sheets : Sheets
        Scans that are scored.
    learnt : Sheets or None
        Scans of the logs of a given model; without them only the nearest ranges are marked.
        Not looked at under other protocols.
    settings : Settings
        Of the model that the baselines stand beside: its labels are learnt.
    asked : Asked
        What all methods share.
    read_out : ReadOut
        Kernel, number of centers and seed.

    Yields
    ------
    Marks
        In the order of ``BASELINES``.
    """
    for name, baseline in BASELINES.items():
        sheet = sheets.of(name)
        nothing = Outcome.nothing(sheet.rows.n_scans)
        if sheet.protocol != "given-model":
            held_out = compare(name, sheet, held_out_fits(name, sheet, asked.pair), read_out)
            in_sample = compare(name, sheet, in_sample_fit(name, sheet, asked.pair), read_out)
            outcomes = held_out, in_sample
        elif learnt is not None:
            fit = given_fit(name, sheet, learnt.of(name), asked.pair)
            outcomes = compare(name, sheet, fit, read_out), nothing
        elif baseline.is_range:
            outcomes = compare(name, sheet, iter(()), read_out), nothing
        else:
            continue
        yield mark(baseline_name(name, settings), asked, sheet, outcomes)


def baseline_name(name: str, settings: Settings) -> Name:
    """Return how the tables name a baseline: it has no profile, whatever it looks at."""
    rows = BASELINES[name].rows
    if rows == "features":
        return Name(
            method=name,
            feature=settings.scan.feature,
            bins=settings.scan.bins,
            readout="kernel",
        )
    if rows == "raw":
        return Name(method=name, feature=RAW_FEATURE, bins=RAW_BINS)
    return Name(method=name)
