"""What ``mpap info`` prints of a model."""

from dataclasses import dataclass
from typing import Annotated

from mpap_cli.commands.describing.facts import ModelFacts
from mpap_cli.commands.info import ModelInfo
from mpap_cli.outputs.text_table import aligned, count, printable
from mpap_cli.systems.columns import LogName
from mpap_cli.systems.labelling import LogSource


@dataclass(frozen=True, slots=True)
class ModelRow:
    """What ``--format csv`` prints of a log that a model has learnt.

    What was not learnt, of scans or of images, is None.
    """

    path: Annotated[str, "the model"]
    profile: Annotated[str, "`robust` or `paper`"]
    feature: Annotated[str, "value of a bin of a scan"]
    bins: Annotated[int, "number of bins of a scan"]
    clusters: Annotated[int | None, "clusters of scans"]
    meta_points: Annotated[int | None, "meta-points of scans"]
    image_clusters: Annotated[int | None, "clusters of patches"]
    exemplars: Annotated[int | None, "exemplars of patches"]
    log: LogName
    scans: Annotated[int | None, "scans learnt from it"]
    images: Annotated[int | None, "images learnt from it"]
    presses: Annotated[int | None, "its presses"]


def model_rows(model: ModelInfo) -> list[ModelRow]:
    """Return the logs of a model, each with what the model is."""
    known = model_facts(model)
    return [
        ModelRow(
            path=known["path"],
            profile=known["profile"],
            feature=known["feature"],
            bins=known["bins"],
            clusters=known["clusters"],
            meta_points=known["meta_points"],
            image_clusters=known["image_clusters"],
            exemplars=known["exemplars"],
            log=log["name"],
            scans=log["scans"],
            images=log["images"],
            presses=log["presses"],
        )
        for log in known["logs"]
    ]


def model_facts(model: ModelInfo) -> ModelFacts:
    """Return what ``--format json`` prints of a model."""
    models = model.models
    scans, images = models.collision, models.appearance
    return {
        "path": str(model.path),
        "profile": models.settings.profile,
        "feature": models.settings.scan.feature,
        "bins": models.settings.scan.bins,
        "clusters": len(scans.clusters()) if scans is not None else None,
        "meta_points": scans.meta_points.n_points if scans is not None else None,
        "image_clusters": len(images.rows()) if images is not None else None,
        "exemplars": images.two_scale.n_clusters if images is not None else None,
        "logs": [
            {
                "name": log.name,
                "scans": _observed(log, scans.logs if scans is not None else ()),
                "images": _observed(log, images.logs if images is not None else ()),
                "presses": log.n_presses,
            }
            for log in models.logs
        ],
    }


def _observed(wanted: LogSource, logs: tuple[LogSource, ...]) -> int | None:
    """Return how much one model has learnt from a log; None if it has not seen it."""
    seen = [
        log.n_observations
        for log in logs
        if (log.name, log.start_ns) == (wanted.name, wanted.start_ns)
    ]
    return sum(seen) if seen else None


def model_text(model: ModelInfo) -> str:
    """Lay out what a model knows."""
    facts = model_facts(model)
    lines = [f"{printable(str(model.path))}: model of profile {facts['profile']}"]
    if facts["clusters"] is not None and facts["meta_points"] is not None:
        lines.append(
            f"  scans: {facts['feature']}, {facts['bins']} bins: "
            f"{count(facts['clusters'], 'cluster')}, {count(facts['meta_points'], 'meta-point')}"
        )
    if facts["image_clusters"] is not None and facts["exemplars"] is not None:
        lines.append(
            f"  images: {count(facts['image_clusters'], 'cluster')} of patches, "
            f"{count(facts['exemplars'], 'exemplar')}"
        )
    cells = [("  log", "scans", "images", "presses")]
    cells += [
        (
            f"  {log['name']}",
            _number(log["scans"]),
            _number(log["images"]),
            _number(log["presses"]),
        )
        for log in facts["logs"]
    ]
    lines += aligned(cells, right={1, 2, 3})
    return "".join(f"{line}\n" for line in lines)


def _number(value: int | None) -> str:
    return "-" if value is None else f"{value:,}"
