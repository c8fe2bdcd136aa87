"""``cluster``: the paper's clusterers and their peers on labelled image patches (5.1.1)."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpap_cli.commands.clustering.members import Ran, member_pictures
from mpap_cli.commands.clustering.patch_settings import clusterer_settings, patch_settings
from mpap_cli.commands.inputs.labelled_patches import read_labelled_patches
from mpap_cli.commands.runtime import keep_kernels_writable, one_thread_each
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.clusterers.methods import CLUSTERERS, is_there, warm_up
from mpap_cli.evaluation.clusterers.records import Clusterer, ClustererSettings, LabelledPoints
from mpap_cli.evaluation.clusterers.scores import ClusteringRow, score_clustering
from mpap_cli.outputs.patch_pictures import write_members
from mpap_cli.outputs.report.page import redraw
from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.tables import write_csv
from mpap_cli.params import settings_values

LOGGER = logging.getLogger(__name__)

PICTURED = ("mpap", "default")
_MOST_SHOWN = 48
_SEEDS = 1 << 32


@dataclass(frozen=True, slots=True, kw_only=True)
class ClusterRequest:
    """Which patches, how many orders of them, and where results go.

    ``per_class`` is the most patches of a class, None for all; ``methods`` the names of the
    methods to run, empty for all.
    """

    patches: Path
    out: Path
    orders: int = 5
    per_class: int | None = None
    methods: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Clustered:
    """Scores of every run, and where they lie."""

    folder: Path
    rows: list[ClusteringRow]
    n_points: int
    class_names: tuple[str, ...]
    n_classes: int
    orders: int
    exit_code: int = 0


def cluster(settings: SettingsRequest, request: ClusterRequest) -> Clustered:
    """Cluster labelled image patches by every method and score the clusters (section 5.1.1).

    Parameters
    ----------
    settings : SettingsRequest
        Settings of features, meta-points, STRAP and affinity propagation, and the seed; see
        :func:`~mpap_cli.commands.clustering.patch_settings.patch_settings`.
    request : ClusterRequest
        Patches, orders, results folder.

    Returns
    -------
    Clustered
        One row a method, variant and order.

    Raises
    ------
    LogError
        If no image can be read.
    UsageError
        If no method is left to run.
    OutputError
        If the results folder cannot be written.
    """
    keep_kernels_writable()
    chosen = patch_settings(settings)
    how = clusterer_settings(chosen, settings)
    seed = chosen.affinity.seed
    with one_thread_each(), ResultsFolder(request.out, "cluster") as results:
        patches = read_labelled_patches(request.patches, chosen.image, request.per_class, seed)
        clusterers = _to_run(request, len(patches.points.classes))
        warm_up()
        rows, pictured = _run_all(clusterers, patches.points, how, request, seed)
        write_csv(results.path("cluster.csv"), ClusteringRow, rows)
        if pictured is not None:
            write_members(
                results.path("members.png"), member_pictures(patches, pictured), _MOST_SHOWN
            )
        values = {
            **settings_values(chosen),
            "theta": "auto" if how.theta_from_points else chosen.meta_point.theta,
            "orders": request.orders,
            "per-class": request.per_class,
            "methods": ",".join(request.methods) or "all",
        }
        results.commit(values, patches.inputs, seed)
    redraw(request.out)
    return Clustered(
        folder=results.folder,
        rows=rows,
        n_points=len(patches.points.classes),
        class_names=patches.class_names,
        n_classes=patches.points.n_classes,
        orders=request.orders,
        exit_code=patches.warn_of_losses(),
    )


def _to_run(request: ClusterRequest, n_points: int) -> dict[tuple[str, str], Clusterer]:
    """Return the clusterers that can take so many points; say which cannot."""
    wanted = {
        key: clusterer
        for key, clusterer in CLUSTERERS.items()
        if not request.methods or key[0] in request.methods
    }
    missing = sorted({key[0] for key, one in wanted.items() if not is_there(one)})
    too_many = sorted(
        {key[0] for key, one in wanted.items() if one.most_points and n_points > one.most_points}
    )
    if missing:
        LOGGER.info("%s: left out, needs the extra streams (river)", ", ".join(missing))
    if too_many:
        most = min(one.most_points or 0 for key, one in wanted.items() if key[0] in too_many)
        LOGGER.warning(
            "%s: left out, %s patches are more than %s; --per-class N takes fewer",
            ", ".join(too_many), f"{n_points:,}", f"{most:,}",
        )  # fmt: skip
    left = {key: one for key, one in wanted.items() if key[0] not in {*missing, *too_many}}
    if not left:
        msg = "cluster: no method is left to run; choose another --method, or give fewer patches"
        raise UsageError(msg)
    return left


def _run_all(
    clusterers: dict[tuple[str, str], Clusterer],
    points: LabelledPoints,
    settings: ClustererSettings,
    request: ClusterRequest,
    seed: int,
) -> tuple[list[ClusteringRow], Ran | None]:
    """Run every clusterer, on every order if that matters; keep the run that is drawn."""
    orders = {
        (seed + number) % _SEEDS: np.random.default_rng(seed + number).permutation(
            len(points.classes)
        )
        for number in range(request.orders)
    }
    rows, pictured = [], None
    for (method, variant), clusterer in clusterers.items():
        unfinished, found = 0, []
        for order_seed, order in orders.items() if clusterer.varies else [(seed, orders[seed])]:
            shuffled = points.in_order(order)
            result = clusterer.run(shuffled, settings, order_seed)
            unfinished += not result.converged
            shown_seed = order_seed if clusterer.varies else None
            found.append(score_clustering(method, variant, shown_seed, shuffled, result))
            if (method, variant) == PICTURED and pictured is None:
                pictured = Ran(order, result)
        rows += found
        _tell(method, variant, found, unfinished)
    return rows, pictured


def _tell(method: str, variant: str, rows: Sequence[ClusteringRow], unfinished: int) -> None:
    """Say how far the work is."""
    seconds = sum(row.seconds for row in rows)
    runs = f"{len(rows)} run{'s' * (len(rows) > 1)}"
    LOGGER.info("%s %s: %s, %.1f s", method, variant, runs, seconds)
    if unfinished:
        LOGGER.warning(
            "%s %s: affinity propagation did not converge in %d of %s; the best state counts",
            method, variant, unfinished, runs,
        )  # fmt: skip
