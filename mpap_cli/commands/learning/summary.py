"""What models know: summed up, and written as the files that every learning command leaves."""

from dataclasses import dataclass
from pathlib import Path

from mpap_cli.commands.inputs.models import Models, save_models
from mpap_cli.outputs.model_file import MODEL_NAME
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.tables import write_csv
from mpap_cli.systems.cluster_rows import ClusterRow


@dataclass(frozen=True, slots=True, kw_only=True)
class LearntScans:
    """What is known of laser scans."""

    clusters: list[ClusterRow]
    n_scans: int
    n_cluster_points: int
    n_meta_points: int


@dataclass(frozen=True, slots=True, kw_only=True)
class LearntImages:
    """What is known of camera images."""

    clusters: list[ClusterRow]
    n_images: int
    n_patches: int
    n_exemplars: int
    n_outliers: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Learnt:
    """What models know, and where they lie; ``n_presses`` is None without a bumper."""

    folder: Path
    profile: str
    n_logs: int
    n_presses: int | None
    scans: LearntScans | None
    images: LearntImages | None
    exit_code: int = 0

    @property
    def clusters(self) -> list[ClusterRow]:
        """The rows of clusters.csv."""
        parts = [part.clusters for part in (self.scans, self.images) if part is not None]
        return [row for part in parts for row in part]


def write_learnt(results: ResultsFolder, models: Models, exit_code: int) -> Learnt:
    """Write clusters.csv and model.npz, and sum up what stands in them.

    Parameters
    ----------
    results : ResultsFolder
        Where both go.
    models : Models
        They learn no further.
    exit_code : int
        How the command will end.

    Returns
    -------
    Learnt
        Clusters and counts.

    Raises
    ------
    OSError
        If a file cannot be written.
    """
    learnt = _summed_up(models, results.folder, exit_code)
    write_csv(results.path("clusters.csv"), ClusterRow, learnt.clusters)
    save_models(results.path(MODEL_NAME), models)
    return learnt


def _summed_up(models: Models, folder: Path, exit_code: int) -> Learnt:
    """Count what models know."""
    for model in (models.collision, models.appearance):
        if model is not None:
            model.finish()
    pressed = [log.n_presses for log in models.logs if log.n_presses is not None]
    return Learnt(
        folder=folder,
        profile=models.settings.profile,
        n_logs=len(models.logs),
        n_presses=sum(pressed) if pressed else None,
        scans=_learnt_scans(models),
        images=_learnt_images(models),
        exit_code=exit_code,
    )


def _learnt_scans(models: Models) -> LearntScans | None:
    model = models.collision
    if model is None:
        return None
    return LearntScans(
        clusters=model.clusters(),
        n_scans=sum(log.n_observations for log in model.logs),
        n_cluster_points=model.self_check().n_cluster_points,
        n_meta_points=model.meta_points.n_points,
    )


def _learnt_images(models: Models) -> LearntImages | None:
    model = models.appearance
    if model is None:
        return None
    return LearntImages(
        clusters=model.rows(),
        n_images=model.n_images,
        n_patches=model.n_images * model.n_patches,
        n_exemplars=model.two_scale.n_clusters,
        n_outliers=model.two_scale.n_reservoir,
    )
