"""What ``mpap predict`` prints, as text or as one row for programs."""

from dataclasses import dataclass
from typing import Annotated

from mpap_cli.commands.predict import Predicted
from mpap_cli.commands.predicting.images import PredictedImages
from mpap_cli.commands.predicting.scans import PredictedScans
from mpap_cli.evaluation.leads import LeadSummary
from mpap_cli.outputs.console import shown
from mpap_cli.outputs.text_table import count, printable


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedRow:
    """What ``predict --format csv`` prints, and json; what was not predicted is None."""

    logs: Annotated[int, "logs that were read"]
    scans: Annotated[int | None, "scans in them"]
    predicted: Annotated[int | None, "scans from `--threshold` up"]
    novel: Annotated[int | None, "scans unlike anything learnt"]
    presses_judged: Annotated[int | None, "presses that could be announced"]
    presses_announced: Annotated[int | None, "those that were"]
    median_lead_s: Annotated[float | None, "median time from announcement to onset"]
    false_alarms_per_min: Annotated[float | None, "alarms wholly outside contact, a minute"]
    images: Annotated[int | None, "images"]
    patches: Annotated[int | None, "patches of images"]
    obstacle_patches: Annotated[int | None, "those that are obstacles"]
    unknown_patches: Annotated[int | None, "those like none learnt"]
    straight: Annotated[int | None, "images after which the robot would go straight on"]
    rotate_left: Annotated[int | None, "images after which it would turn left"]
    rotate_right: Annotated[int | None, "images after which it would turn right"]
    stop: Annotated[int | None, "images after which it would stop"]
    contacts: Annotated[int | None, "presses with images before them"]
    contacts_foreseen: Annotated[int | None, "those before which it would have stopped or turned"]
    stopping_distance_m: Annotated[
        float | None, "mean distance of the thing ahead when the decision turned against going on"
    ]
    stopping_distance_sd_m: Annotated[float | None, "standard deviation of that"]
    stops_measured: Annotated[int | None, "decisions with a range ahead"]


def predicted_row(predicted: Predicted) -> PredictedRow:
    """Sum up what was predicted."""
    scans, images = predicted.scans, predicted.images
    leads = scans.leads if scans else None
    actions = images.actions if images else {}
    stopping = images.stopping if images else None
    return PredictedRow(
        logs=predicted.n_logs,
        scans=scans.n_scans if scans else None,
        predicted=scans.n_predicted if scans else None,
        novel=scans.n_novel if scans else None,
        presses_judged=leads.judged if leads else None,
        presses_announced=leads.announced if leads else None,
        median_lead_s=leads.median_lead_s if leads else None,
        false_alarms_per_min=leads.false_alarms_per_min if leads else None,
        images=images.n_images if images else None,
        patches=images.n_patches if images else None,
        obstacle_patches=images.n_obstacle if images else None,
        unknown_patches=images.n_unknown if images else None,
        straight=actions.get("straight"),
        rotate_left=actions.get("rotate-left"),
        rotate_right=actions.get("rotate-right"),
        stop=actions.get("stop"),
        contacts=images.contacts if images else None,
        contacts_foreseen=images.contacts_foreseen if images else None,
        stopping_distance_m=stopping.mean_m if stopping else None,
        stopping_distance_sd_m=stopping.sd_m if stopping else None,
        stops_measured=stopping.measured if stopping else None,
    )


def predicted_text(predicted: Predicted) -> str:
    """Lay out what was predicted."""
    lines = []
    if predicted.scans is not None:
        lines += _scan_lines(predicted.scans, predicted)
    if predicted.images is not None:
        lines += _image_lines(predicted.images, predicted)
    lines.append(f"results: {printable(str(predicted.folder))}")
    return "".join(f"{line}\n" for line in lines)


def _scan_lines(scans: PredictedScans, predicted: Predicted) -> list[str]:
    """Say what was predicted of scans."""
    lines = [
        (
            f"{count(scans.n_scans, 'scan')} of {count(predicted.n_logs, 'log')}: "
            f"{scans.n_predicted:,} with p >= {predicted.threshold:g}, "
            f"{scans.n_novel:,} unlike anything learnt"
        )
    ]
    lines += _announced(scans.leads, "announced")
    return lines + (_announced(scans.alarms, "announced by alarms") if scans.alarms else [])


def _announced(leads: LeadSummary, how: str) -> list[str]:
    """Say how many presses were announced, how early, and at what price."""
    if not leads.judged or leads.median_lead_s is None:
        return []
    text = (
        f"{leads.announced} of {count(leads.judged, 'press')} {how}, "
        f"median lead {leads.median_lead_s:.1f} s, "
        f"{shown(leads.false_alarms_per_min)} false alarms a minute"
    )
    return [text]


def _image_lines(images: PredictedImages, predicted: Predicted) -> list[str]:
    """Say what was predicted of images, and what the robot would have done."""
    whole = max(images.n_patches, 1)
    actions = ", ".join(f"{name} {n:,}" for name, n in images.actions.items())
    lines = [
        (
            f"{count(images.n_images, 'image')} of {count(predicted.n_logs, 'log')}: "
            f"{images.n_obstacle / whole:.1%} of {images.n_patches:,} patches are obstacles "
            f"(p >= {images.patch_threshold:g}), {images.n_unknown / whole:.1%} unknown"
        ),
        f"decisions: {actions}",
    ]
    if images.contacts:
        lines.append(
            f"stop or turn before {images.contacts_foreseen} of {count(images.contacts, 'contact')}"
        )
    stopping = images.stopping
    if stopping.mean_m is not None:
        lines.append(
            f"stopping distance {stopping.mean_m:.2f} +- {shown(stopping.sd_m)} m "
            f"({count(stopping.measured, 'stop')}; the paper: 0.94 +- 0.23 m)"
        )
    return lines
