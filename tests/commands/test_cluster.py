"""``cluster``: one row a run, the same each time, and pictures of the clusters."""

import csv
import importlib.util
import json
import logging
import math
from pathlib import Path

import cv2
import numpy as np
import pytest

from mpap_cli.commands.cluster import ClusterRequest, cluster
from mpap_cli.commands.clustering.members import Ran, member_pictures
from mpap_cli.commands.clustering.patch_settings import clusterer_settings, patch_settings
from mpap_cli.commands.inputs.labelled_patches import read_labelled_patches
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.errors import UsageError
from mpap_cli.evaluation.clusterers.methods import CLUSTERERS
from mpap_cli.evaluation.clusterers.records import Clusterer, ClusteringResult
from mpap_cli.params import ImageParams
from tests.commands.patch_sets import CLASSES, arrays, write_folder, write_npz

COLUMNS = (
    "method,variant,order_seed,clusters,points,clustered_points,coverage,v_measure,homogeneity,"
    "completeness,ari,seconds"
)
QUICK = ("ap", "mpap", "k-means", "hdbscan")


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an npz file of 90 patches in three classes."""
    return write_npz(tmp_path_factory.mktemp("patches") / "patches.npz")


def rows_of(path: Path) -> list[dict[str, str]]:
    """Read a table."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_every_run_is_a_row(tmp_path: Path, archive: Path) -> None:
    """Columns as agreed; orders for what depends on them, else one row without an order."""
    request = ClusterRequest(patches=archive, out=tmp_path, orders=2)

    found = cluster(SettingsRequest(), request)

    rows = rows_of(tmp_path / "cluster" / "cluster.csv")
    header = (tmp_path / "cluster" / "cluster.csv").read_text().splitlines()[0]
    orders: dict[tuple[str, str], list[str]] = {(row["method"], row["variant"]): [] for row in rows}
    for row in rows:
        orders[row["method"], row["variant"]].append(row["order_seed"])
    assert header == COLUMNS
    assert len(rows) == len(found.rows)
    assert orders["mpap", "default"] == orders["k-means", "raw"] == ["0", "1"]
    assert orders["ap", "default"] == orders["mean-shift", "default"] == [""]
    assert {row["points"] for row in rows} == {"90"}
    assert found.exit_code == 0
    assert {name for name, _ in orders} >= {"ap", "mpap", "strap", "k-means", "mean-shift"}


def test_clear_classes_are_found(tmp_path: Path, archive: Path) -> None:
    """Three surfaces of different color and grain: V-measure above .9 for mpap."""
    request = ClusterRequest(patches=archive, out=tmp_path, orders=3, methods=("mpap",))

    found = cluster(SettingsRequest(pairs=("min-points=2",)), request)

    assert min(row.v_measure for row in found.rows if row.variant == "default") > 0.9


def test_the_same_seed_gives_the_same_table(tmp_path: Path, archive: Path) -> None:
    """All but the seconds are the same; another seed has other orders."""
    settings = SettingsRequest(flags={"seed": "7"})

    tables = []
    for name in ("a", "b"):
        request = ClusterRequest(patches=archive, out=tmp_path / name, orders=2, methods=QUICK)
        cluster(settings, request)
        rows = rows_of(tmp_path / name / "cluster" / "cluster.csv")
        tables.append([{**row, "seconds": ""} for row in rows])

    pictures = [(tmp_path / name / "cluster" / "members.png").read_bytes() for name in "ab"]
    assert tables[0] == tables[1]
    assert pictures[0] == pictures[1]
    assert {row["order_seed"] for row in tables[0]} == {"", "7", "8"}


def test_the_greatest_seed_has_orders_too(tmp_path: Path, archive: Path) -> None:
    """Seeds behind the last one begin anew, since k-means takes 32 bits."""
    request = ClusterRequest(patches=archive, out=tmp_path, orders=2, methods=("k-means",))

    found = cluster(SettingsRequest(flags={"seed": "4294967295"}), request)

    assert {row.order_seed for row in found.rows} == {4294967295, 0}


def test_what_was_used_is_written_beside_the_results(tmp_path: Path, archive: Path) -> None:
    """Theta is auto unless it was set; the input is there by name and sum."""
    settings = {"auto": SettingsRequest(), "set": SettingsRequest(pairs=("theta=0.15",))}
    for name, asked in settings.items():
        request = ClusterRequest(patches=archive, out=tmp_path / name, orders=1, methods=("mpap",))
        cluster(asked, request)

    records = [
        json.loads((tmp_path / name / "cluster" / "settings.json").read_text())
        for name in ("auto", "set")
    ]
    assert [record["settings"]["theta"] for record in records] == ["auto", 0.15]
    assert records[0]["inputs"][0]["name"] == "patches.npz"
    assert sorted(records[0]["outputs"]) == ["cluster.csv", "members.png"]


def test_members_are_drawn_for_mpap_alone(tmp_path: Path, archive: Path) -> None:
    """Without mpap there is no picture."""
    request = ClusterRequest(patches=archive, out=tmp_path, orders=1, methods=("k-means",))

    cluster(SettingsRequest(), request)

    assert sorted(path.name for path in (tmp_path / "cluster").iterdir()) == [
        "cluster.csv",
        "settings.json",
    ]


def test_members_go_from_near_to_far(archive: Path) -> None:
    """The largest cluster comes first, with its exemplar, 12 members and its main class."""
    patches = read_labelled_patches(archive, ImageParams())
    order = np.random.default_rng(0).permutation(90)
    labels = np.where(patches.points.classes[order] == 1, 0, 1)
    exemplars = np.array([np.flatnonzero(labels == one)[0] for one in (0, 1)])
    result = ClusteringResult(
        labels=labels, clusters=2, clustered_points=2, coverage=1.0, seconds=0, exemplars=exemplars
    )

    found = member_pictures(patches, Ran(order, result))

    assert [one.observations for one in found] == [60, 30]
    assert [len(one.members) for one in found] == [12, 12]
    assert [one.note for one in found] == [f"50 % {CLASSES[0]}", f"100 % {CLASSES[1]}"]
    expected = arrays()["patches"][order[exemplars[0]]][..., ::-1]
    np.testing.assert_array_equal(found[1].exemplar, expected)


def test_a_cluster_without_a_point_has_its_exemplar(archive: Path) -> None:
    """An exemplar may lie nearer to a cluster-point of another cluster."""
    patches = read_labelled_patches(archive, ImageParams())
    result = ClusteringResult(
        labels=np.zeros(90, np.int64),
        clusters=2,
        clustered_points=2,
        coverage=1.0,
        seconds=0,
        exemplars=np.array([4, 8]),
    )

    found = member_pictures(patches, Ran(np.arange(90), result))

    assert [one.observations for one in found] == [90, 0]
    assert found[1].note == "no patch"
    assert found[1].exemplar is not None


def test_one_class_has_empty_scores(tmp_path: Path) -> None:
    """Clusters are made, scores are empty."""
    path = write_npz(tmp_path / "one.npz", **arrays(30, 1))
    request = ClusterRequest(patches=path, out=tmp_path, orders=1, methods=QUICK)

    found = cluster(SettingsRequest(), request)

    assert found.n_classes == 1
    assert all(math.isnan(row.v_measure) for row in found.rows)
    assert all(row["ari"] == "" for row in rows_of(tmp_path / "cluster" / "cluster.csv"))


def test_damaged_images_are_code_3(tmp_path: Path) -> None:
    """The rest is clustered."""
    folder = write_folder(tmp_path / "set", n_images=1)
    (folder / CLASSES[0] / "cut.jpg").write_bytes(b"\xff\xd8\xff")
    request = ClusterRequest(patches=folder, out=tmp_path, orders=1, methods=("mpap",))

    found = cluster(SettingsRequest(), request)

    assert found.exit_code == 3
    assert found.n_points == 75


def test_what_takes_the_square_of_many_points_is_left_out(
    tmp_path: Path,
    archive: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """Methods that cannot take so many points are named; with no other left that is an error."""
    small = {
        key: (one if one.most_points is None else Clusterer(one.run, most_points=50))
        for key, one in CLUSTERERS.items()
    }
    monkeypatch.setattr("mpap_cli.commands.cluster.CLUSTERERS", small)
    request = ClusterRequest(patches=archive, out=tmp_path, orders=1, methods=QUICK)

    found = cluster(SettingsRequest(), request)
    with pytest.raises(UsageError, match="no method is left to run"):
        cluster(SettingsRequest(), ClusterRequest(patches=archive, out=tmp_path, methods=("ap",)))

    assert {row.method for row in found.rows} == {"mpap", "k-means"}
    assert "ap, hdbscan: left out, 90 patches are more than 50" in caplog.text


def test_what_did_not_converge_or_is_not_installed_is_told(
    tmp_path: Path,
    archive: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """One line each; DenStream has no row where river is missing."""
    monkeypatch.setattr(importlib.util, "find_spec", lambda _name: None)
    request = ClusterRequest(
        patches=archive, out=tmp_path, orders=1, methods=("ap", "mpap", "denstream")
    )

    with caplog.at_level(logging.INFO):
        found = cluster(SettingsRequest(pairs=("max-iter=1",)), request)

    assert "ap default: affinity propagation did not converge in 1 of 1 run" in caplog.text
    assert "denstream: left out, needs the extra streams (river)" in caplog.text
    assert "denstream" not in {row.method for row in found.rows}


@pytest.mark.parametrize(
    ("request_", "theta", "automatic"),
    [
        (SettingsRequest(), 0.13, True),
        (SettingsRequest(pairs=("theta=0.13",)), 0.13, False),
        (SettingsRequest(pairs=("min-points=7",)), 0.13, True),
        (SettingsRequest(profile="paper"), 0.2, False),
        (SettingsRequest(profile="paper", pairs=("theta=0.16",)), 0.16, False),
    ],
)
def test_theta_comes_from_the_patches_unless_it_is_set(
    request_: SettingsRequest, theta: float, automatic: bool
) -> None:
    """Profile paper has the theta that the paper prints for images."""
    settings = patch_settings(request_)

    found = clusterer_settings(settings, request_)

    assert found.meta_point.theta == theta
    assert found.theta_from_points is automatic


@pytest.mark.shared
@pytest.mark.slow
def test_photographs_of_textures(tmp_path: Path, shared_logs: Path) -> None:
    """With nothing set mpap reaches .82, affinity propagation over all points less .02."""
    textures = shared_logs.parent / "textures" / "patches.npz"
    request = ClusterRequest(patches=textures, out=tmp_path, methods=("ap", "mpap"))

    found = cluster(SettingsRequest(), request)

    own = [row for row in found.rows if (row.method, row.variant) == ("mpap", "default")]
    mpap = float(np.mean([row.v_measure for row in own]))
    ap = max(row.v_measure for row in found.rows if row.method == "ap")
    seconds = min(row.seconds for row in found.rows if row.method == "ap")
    assert len(own) == 5
    assert mpap >= 0.82
    assert mpap >= ap - 0.02
    assert max(row.seconds for row in own) < seconds / 2
    assert cv2.imread(str(tmp_path / "cluster" / "members.png")) is not None
