"""``evaluate``: collision prediction scored by a protocol, with the baselines beside it."""

from dataclasses import dataclass
from pathlib import Path

from mpap_cli.commands.evaluating.learnt_settings import learnt_settings
from mpap_cli.commands.evaluating.observed import (
    ObservedInput,
    drop_recording,
    learnt_last,
    observe_logs,
)
from mpap_cli.commands.evaluating.outputs import write_evaluation
from mpap_cli.commands.evaluating.summary import summarize
from mpap_cli.commands.evaluating.variants import make_variants
from mpap_cli.commands.inputs.models import load_collision_model, recorded_beside
from mpap_cli.commands.inputs.progress import Progress, no_progress
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.groups import group_names
from mpap_cli.evaluation.rows import AucRow
from mpap_cli.evaluation.scoring import Variant, evaluate_all
from mpap_cli.evaluation.sheets import Question
from mpap_cli.evaluation.targets import Target, parse_target
from mpap_cli.observations import Press
from mpap_cli.outputs.evaluate_text import EvaluateSummary
from mpap_cli.outputs.model_file import find_model
from mpap_cli.outputs.report.page import redraw
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile, describe_input
from mpap_cli.properties.press_files import presses_from_csv, presses_of_log, rows_of_logs
from mpap_cli.systems.collision import CollisionModel


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluateRequest:
    """What is scored, and how.

    ``protocol`` None takes what the logs allow; ``groups`` is folder, a regular
    expression or a CSV file; ``target`` contact, onset or early:S; ``truth`` a CSV of
    presses; ``sweep`` KEY=V1,V2,...; ``model`` is scored as it is.
    """

    out: Path
    protocol: str | None = None
    groups: str | None = None
    target: str = "contact"
    truth: Path | None = None
    sweep: str | None = None
    threshold: float = 0.2
    model: Path | None = None
    jobs: int = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Evaluated:
    """What was found, and where it lies; the first of ``rows`` is mpap as asked."""

    folder: Path
    rows: list[AucRow]
    summary: EvaluateSummary
    exit_code: int = 0


def evaluate(
    selection: LogSelection,
    settings: SettingsRequest,
    request: EvaluateRequest,
    progress: Progress = no_progress,
) -> Evaluated:
    """Score collision prediction (section 5.2 of the paper).

    Parameters
    ----------
    selection : LogSelection
        Logs; without any, those that were learnt last.
    settings : SettingsRequest
        Profile and settings; without any, those learnt. Feature ``all`` and several bins
        are scored one by one.
    request : EvaluateRequest
        Protocol, target, truth, results folder.
    progress : Progress, optional
        Told how far each log is.

    Returns
    -------
    Evaluated
        Rows of auc.csv and the summary that is printed.

    Raises
    ------
    UsageError
        If there is nothing to score yet, or what is asked for does not fit together.
    LogError
        If no log can be read.
    OutputError
        If results cannot be read or written.
    """
    keep_kernels_writable()
    model = _given_model(settings, request)
    learnt = learnt_settings(request.out)
    variants = make_variants(settings, request.sweep, learnt, model)
    target = parse_target(request.target)
    with one_thread_each(), ResultsFolder(request.out, "evaluate") as results:
        if selection.logs:
            first = variants[0].settings
            observed = observe_logs(selection, first, results, request.jobs, progress)
        else:
            observed = learnt_last(request.out, selection)
        question = _question(observed, request, target, model)
        evaluation = evaluate_all(question, variants)
        write_evaluation(results, evaluation)
        drop_recording(results)
        results.commit(
            _values(selection, request, observed, variants),
            [*observed.inputs, *_files_asked(request)],
            variants[0].settings.affinity.seed,
        )
    redraw(request.out)
    return Evaluated(
        folder=results.folder,
        rows=[marks.row for marks in evaluation.marks],
        summary=summarize(evaluation, question, variants, settings, learnt=learnt is not None),
        exit_code=observed.exit_code,
    )


def _given_model(settings: SettingsRequest, request: EvaluateRequest) -> CollisionModel | None:
    """Return the model of --model, which brings its own settings and protocol."""
    if request.model is None:
        return None
    if not settings.says_nothing:
        msg = (
            "--model is scored with its own settings; leave out --feature, --bins, --profile, --set"
        )
        raise UsageError(msg)
    if request.protocol is not None or request.sweep is not None:
        msg = "--model is scored as it is; leave out --protocol and --sweep"
        raise UsageError(msg)
    return load_collision_model(request.model)


def _files_asked(request: EvaluateRequest) -> list[InputFile]:
    """Describe the files beside the logs that a result depends on."""
    files = [find_model(request.model)] if request.model is not None else []
    files += [request.truth] if request.truth is not None else []
    if request.groups is not None and request.groups.endswith(".csv"):
        files.append(Path(request.groups))
    return [describe_input(file) for file in files]


def _question(
    observed: ObservedInput,
    request: EvaluateRequest,
    target: Target,
    model: CollisionModel | None,
) -> Question:
    """Put together what is asked of the evaluation."""
    truth, truth_name = _truth(observed, request)
    return Question(
        logs=observed.logs,
        target=target,
        protocol=request.protocol,
        groups=group_names(observed.logs, request.groups) if request.groups else None,
        threshold=request.threshold,
        truth=truth,
        truth_name=truth_name,
        model=model,
        model_logs=recorded_beside(request.model) if request.model is not None else None,
    )


def _truth(
    observed: ObservedInput, request: EvaluateRequest
) -> tuple[tuple[tuple[Press, ...] | None, ...] | None, str]:
    """Return the presses of --truth log by log, and what the truth is called."""
    if request.truth is None:
        kinds = {log.bump_source.partition(" ")[0] for log in observed.logs} - {"none"}
        return None, "+".join(sorted(kinds)) or "none"
    names = [log.name for log in observed.logs]
    rows = rows_of_logs(presses_from_csv(request.truth), names, f"--truth {request.truth.name}")
    presses = tuple(
        presses_of_log(rows.get(log.name, ()), index, log.start_ns, log.end_ns)
        for index, log in enumerate(observed.logs)
    )
    return presses, request.truth.name


def _values(
    selection: LogSelection,
    request: EvaluateRequest,
    observed: ObservedInput,
    variants: list[Variant],
) -> dict[str, object]:
    """Return all that can change results, for settings.json."""
    return {
        **selection.values(variants[0].settings),
        **observed.values,
        "protocol": request.protocol,
        "groups": Path(request.groups).name if request.groups else None,
        "target": request.target,
        "truth": request.truth.name if request.truth else None,
        "sweep": request.sweep,
        "threshold": request.threshold,
        "methods": [variant.method for variant in variants],
    }
