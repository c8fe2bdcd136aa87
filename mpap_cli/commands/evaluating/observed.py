"""The logs that are scored: those given, or the recording of what was learnt last."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpap_cli.commands.inputs.press_file import press_inputs
from mpap_cli.commands.inputs.press_tracking import LogPresses
from mpap_cli.commands.inputs.progress import Progress
from mpap_cli.commands.inputs.replaying import follow
from mpap_cli.commands.inputs.selection import LogSelection
from mpap_cli.commands.inputs.sources import Losses, Source, open_sources
from mpap_cli.commands.learning.recorder import Recorder
from mpap_cli.errors import UsageError
from mpap_cli.observations import ObservedLog, Press
from mpap_cli.outputs.recording import RECORDING_NAME, read_recording
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile, describe_input, has_results, read_results
from mpap_cli.params import Settings, setting_fields


@dataclass(frozen=True, slots=True, kw_only=True)
class ObservedInput:
    """Logs with their presses, and where they come from.

    ``values`` are what settings.json says of the input.
    """

    logs: tuple[ObservedLog, ...]
    inputs: tuple[InputFile, ...]
    values: dict[str, Any]
    exit_code: int = 0


def learnt_last(out: Path, selection: LogSelection) -> ObservedInput:
    """Return the logs of the last ``learn`` in a results folder.

    Parameters
    ----------
    out : Path
        Results folder.
    selection : LogSelection
        What was said of logs: nothing, since none is read.

    Returns
    -------
    ObservedInput
        As recorded.

    Raises
    ------
    UsageError
        If nothing was learnt there, no recording was kept, or something was said.
    OutputError
        If the results are mixed or damaged.
    """
    if selection.options_said:
        option = selection.options_said[0]
        msg = f"{option} needs LOG; without LOG evaluate scores what was learnt"
        raise UsageError(msg)
    folder = out / "learn"
    if not has_results(folder):
        msg = f"{folder}: nothing learnt yet; run mpap learn LOG... first, or name the logs"
        raise UsageError(msg)
    results = read_results(folder)
    if RECORDING_NAME not in results.outputs:
        msg = f"{folder}: learnt with --no-recording; name the logs to score"
        raise UsageError(msg)
    keys = setting_fields()
    return ObservedInput(
        logs=tuple(read_recording(results.path(RECORDING_NAME))),
        inputs=results.inputs,
        values={  # what is scored may be of another profile, but not of another forward
            key: value
            for key, value in results.settings.items()
            if (key not in keys and key != "profile") or key == "forward"
        },
    )


def observe_logs(
    selection: LogSelection,
    settings: Settings,
    results: ResultsFolder,
    jobs: int,
    progress: Progress,
) -> ObservedInput:
    """Read logs into a recording of their own, which is dropped with :func:`drop_recording`.

    Raises
    ------
    LogError
        If no log can be read.
    UsageError
        If a log has no scan topic.
    """
    losses, inputs = Losses(), list[InputFile]()
    recording = results.path(RECORDING_NAME)
    with Recorder(recording) as recorder:
        for source in open_sources(selection, settings, losses):
            recorder.end_log(source, _presses(source, settings, recorder, jobs, progress))
            inputs.append(describe_input(source.path))
        recorder.require_scans()
    inputs += press_inputs(selection)
    return ObservedInput(
        logs=tuple(read_recording(recording)),
        inputs=tuple(inputs),
        values={},
        exit_code=losses.exit_code,
    )


def drop_recording(results: ResultsFolder) -> None:
    """Remove the recording that :func:`observe_logs` made; it is no result."""
    results.path(RECORDING_NAME).unlink(missing_ok=True)


def _presses(
    source: Source, settings: Settings, recorder: Recorder, jobs: int, progress: Progress
) -> tuple[Press, ...] | None:
    """Replay a log for its scans and presses."""
    presses = LogPresses(source, settings.bumper)
    recorder.begin_log()
    for batch, _ in follow(source, jobs, progress, "read"):
        recorder.record(batch)
        presses.add(batch)
    return presses.end()
