"""An appearance model learns from batches, whichever way they come."""

import threading
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mpap_cli.observations import Batch, Bump, Frame, PatchBlock, PoseBlock, Press
from mpap_cli.params import make_settings
from mpap_cli.properties.driven import driven_ahead
from mpap_cli.properties.obstacle_labels import label_patches
from mpap_cli.systems.appearance import AppearanceModel
from mpap_cli.systems.labelling import LogStart
from tests.systems.conftest import CameraDrive

VALUES = {"image-size": "96x72", "reservoir": "80", "eps": "0.25"}
SETTINGS = make_settings(values=VALUES)

Drive = Callable[[int, int], CameraDrive]
Seen = Callable[..., AppearanceModel]


def n_labels(model: AppearanceModel) -> list[int]:
    """Sum the labels over clusters and reservoir: negative, positive."""
    state = model.two_scale.state()
    sums = state["clusters.labels"].sum(axis=0) + state["reservoir.labels"].sum(axis=0)
    return [int(value) for value in sums]


def patches_of(drive: CameraDrive) -> PatchBlock:
    """Return the patches of a log."""
    return AppearanceModel(SETTINGS).embed(drive.frames)


@pytest.mark.parametrize("profile", ["robust", "paper"])
def test_a_replay_counts_the_labels_of_the_whole_log(
    profile: str, camera_drive: Drive, seen: Seen
) -> None:
    """Queue, tracker, rebuilds and merges lose no label and count none twice."""
    settings = make_settings(profile, VALUES)
    drive = camera_drive(96, 1)
    stamps_ns = np.array([frame.stamp_ns for frame in drive.frames])
    driven_m = driven_ahead(stamps_ns, drive.poses, settings.obstacle.driven_before_s)
    labels = label_patches(stamps_ns, drive.presses, settings.obstacle, (6, 6), driven_m)

    model = seen(settings, size=16)

    assert model.two_scale.n_rebuilds > 1
    assert n_labels(model) == [int((labels == 0).sum()), int((labels == 1).sum())]


def test_the_size_of_batches_does_not_matter(seen: Seen) -> None:
    """The state of the model has the same bytes."""
    one, other = seen(SETTINGS, size=7).state(), seen(SETTINGS, size=480).state()

    assert one.header == other.header
    assert {name: array.tobytes() for name, array in one.arrays.items()} == {
        name: array.tobytes() for name, array in other.arrays.items()
    }


def test_walls_are_obstacles_and_floor_is_none(camera_drive: Drive, seen: Seen) -> None:
    """On a drive that was not learnt; p is filled for every patch."""
    drive = camera_drive(24, 9)
    block = patches_of(drive)

    found = seen(SETTINGS).predict(block)

    pressed = (drive.presses[0].start_ns <= block.stamps_ns) & (
        block.stamps_ns < drive.presses[0].end_ns
    )
    assert found.p_obstacle[pressed].mean() > 0.6
    assert found.p_obstacle[:, 30:][:20].max() < 0.1
    assert not np.isnan(found.p_obstacle).any()
    assert found.unknown.mean() < 0.1


def test_rows_add_up(seen: Seen) -> None:
    """Patches, labels and exemplars are those of the clusters; presses and visits are real."""
    model = seen(SETTINGS)

    rows = model.rows()

    assert [row.cluster for row in rows] == list(range(len(rows)))
    assert {(row.sensor, row.feature, row.bins) for row in rows} == {("image", "hsv+lbp", 36)}
    assert sum(row.meta_points for row in rows) == model.two_scale.n_clusters
    assert sum(row.observations for row in rows) == 480 * 36 - model.two_scale.n_reservoir
    assert sum(row.collisions for row in rows) == model.two_scale.labels[:, 1].sum()
    assert max(row.presses for row in rows) == 8
    assert all(row.visits >= 1 for row in rows)
    shares = [row.collisions / (row.collisions + row.non_collisions) for row in rows]
    p = np.array([row.p_collision for row in rows], dtype=np.float64)
    assert p == pytest.approx(shares, abs=0.1)
    assert np.argsort(p).tolist() == np.argsort(shares).tolist()
    for row in rows:
        assert 10 <= row.first_seen_s <= row.exemplar_time_s <= row.last_seen_s <= 106


def test_pictures_are_found_in_the_log(camera_drive: Drive, seen: Seen) -> None:
    """The exemplar first; members are other exemplars of the cluster, at most twelve."""
    model = seen(SETTINGS)
    stamps_ns = {frame.stamp_ns for frame in camera_drive(96, 1).frames}

    pictures = model.pictures()

    rows = model.rows()
    assert [picture.exemplar[1] for picture in pictures] == [row.exemplar_stamp_ns for row in rows]
    for picture, row in zip(pictures, rows, strict=True):
        assert picture.exemplar not in picture.members
        assert len(picture.members) == min(12, row.meta_points - 1)
        for name, stamp_ns, patch in (picture.exemplar, *picture.members):
            assert (name, stamp_ns in stamps_ns, 0 <= patch < 36) == ("1.bag", True, True)


def test_a_discrepancy_is_found(seen: Seen) -> None:
    """The wall in the path counts as driven floor until it is near, then as obstacle."""
    model = seen(SETTINGS)

    found = model.discrepancies()

    assert found == [row for row in model.rows() if 0.2 < (row.p_collision or 0) < 0.8]
    assert len(found) > 0


def test_a_log_without_bumper_clusters_only(camera_drive: Drive) -> None:
    """No labels, no probabilities, no presses; patches are seen all the same."""
    drive = camera_drive(24, 3)
    model = AppearanceModel(SETTINGS)
    model.begin_log(LogStart(name="a", start_ns=0))
    model.observe(Batch(drive.end_ns, (), (), drive.frames, drive.poses))

    presses = model.end_log(drive.end_ns)

    assert presses is None
    assert (model.logs[0].n_presses, model.n_images) == (None, 120)
    assert n_labels(model) == [0, 0]
    assert {row.p_collision for row in model.rows()} == {None}
    assert np.isnan(model.predict(patches_of(drive)).p_obstacle).all()


def test_a_log_without_images_is_learnt() -> None:
    """There is nothing to cluster and nothing to say."""
    model = AppearanceModel(SETTINGS)
    model.begin_log(LogStart(name="a", start_ns=5, bump_kind="level"))
    learnt = model.observe(Batch(50, (), (Bump(10, "", pressed=True),)))

    presses = model.end_log(60)

    assert learnt.ids.shape == (0, 36)
    assert presses == (Press(10, 61, held_from_start=True, released=False),)
    assert (model.rows(), model.pictures(), model.discrepancies()) == ([], [], [])
    assert model.known().unknown(np.zeros((0, 36, 109), dtype=np.float32)).size == 0


def test_few_patches_become_clusters_at_the_end_of_the_log(camera_drive: Drive) -> None:
    """Even if there are fewer than the reservoir holds."""
    drive = camera_drive(2, 1)
    model = AppearanceModel(make_settings(values={**VALUES, "reservoir": "10000"}))
    model.begin_log(LogStart(name="a", start_ns=0, presses=drive.presses))
    learnt = model.observe(Batch(drive.end_ns, (), (), drive.frames))

    model.end_log(drive.end_ns)

    assert learnt.outlier.all()
    assert np.isinf(learnt.distance).all()
    assert sum(row.observations for row in model.rows()) == 360


def test_embedding_runs_ahead_in_another_thread(camera_drive: Drive, seen: Seen) -> None:
    """The model is the same as if all was done one after the other."""
    drive = camera_drive(96, 1)
    model = AppearanceModel(SETTINGS)
    start = LogStart(name="1.bag", start_ns=0, bump_kind="level", bump_source="bumper")
    model.begin_log(start)
    blocks: list[PatchBlock] = []
    ready = threading.Semaphore(0)

    def embed() -> None:
        for batch in drive.batches(32):
            blocks.append(model.embed(batch.frames))
            ready.release()

    thread = threading.Thread(target=embed)
    thread.start()
    for index, batch in enumerate(drive.batches(32)):
        ready.acquire()
        model.learn(blocks[index])
        model.settle(batch.bumps, batch.poses, batch.until_ns)
    thread.join()
    model.end_log(drive.end_ns)

    assert model.rows() == seen(SETTINGS).rows()


def test_what_cannot_be_used_is_counted_for_each_log(camera_drive: Drive) -> None:
    """Broken images leave a gap; the next log begins at nought."""
    drive = camera_drive(4, 1)
    broken = replace(drive.frames[3], payload=b"")
    frames = (*drive.frames[:3], broken, *drive.frames[4:])
    model = AppearanceModel(SETTINGS)

    model.begin_log(LogStart(name="a", start_ns=0))
    learnt = model.observe(Batch(drive.end_ns, (), (), frames))
    model.end_log(drive.end_ns)
    n_skipped = model.skipped.total()
    model.begin_log(LogStart(name="b", start_ns=0))

    assert (n_skipped, model.skipped.total(), model.changes.total()) == (1, 0, 0)
    assert learnt.block.stamps_ns.size == model.n_images == 19
    assert (learnt.block.kept != 3).all()


def test_a_changed_size_is_told_and_used(camera_drive: Drive) -> None:
    """Images are brought to one size."""
    frames = camera_drive(1, 1).frames
    small = Frame(frames[-1].stamp_ns + 1, "mono8", 48, 36, 48, bytes(range(48)) * 36)
    model = AppearanceModel(SETTINGS)

    block = model.embed((*frames, small))

    assert block.kept.size == len(frames) + 1
    assert set(model.changes.elements()) == {"size changes", "encoding changes"}


def test_standing_still_is_no_driven_floor(camera_drive: Drive) -> None:
    """With odometry that does not move there is no negative label; without, time alone counts."""
    drive = camera_drive(24, 1)
    start = LogStart(name="a", start_ns=0, presses=drive.presses)
    still = PoseBlock(drive.poses.stamps_ns, np.zeros_like(drive.poses.poses))
    found = {}
    for name, poses in (("still", still), ("none", None)):
        model = AppearanceModel(SETTINGS)
        model.begin_log(start)
        model.observe(Batch(drive.end_ns, (), (), drive.frames, poses))
        model.end_log(drive.end_ns)
        found[name] = n_labels(model)
        assert (model.n_labels["free"], model.n_labels["obstacle"]) == tuple(found[name])

    assert found["still"][0] == 0
    assert found["still"][1] == found["none"][1] > 0
    assert found["none"][0] > 0


def test_a_log_is_begun_before_it_is_observed() -> None:
    """Else nothing is known of it."""
    model = AppearanceModel(SETTINGS)

    with pytest.raises(RuntimeError, match="begin_log comes first"):
        model.settle((), None, 0)
