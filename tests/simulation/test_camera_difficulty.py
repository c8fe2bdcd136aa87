"""Patches of simulated images are neither trivial nor hopeless to tell apart."""

import cv2
import numpy as np
import pytest
from sklearn.cluster import KMeans
from sklearn.metrics import homogeneity_score, v_measure_score

from mpap_cli.features.images.patch_features import PatchEmbedder
from mpap_cli.observations import Float32Array, Frame, IntArray
from mpap_cli.params import ImageParams
from mpap_cli.simulation.camera import Camera
from mpap_cli.simulation.camera_truth import material_counts
from mpap_cli.simulation.palettes import PALETTES
from mpap_cli.simulation.robot import STEP_NS, Walker
from mpap_cli.simulation.settings import PLACES

_EVERY = 50


def pure_patches(place: str, textures: str, light: str) -> tuple[Float32Array, IntArray]:
    """Return features and material of patches that show one for 90 %, over six minutes."""
    world = PLACES[place].build(np.random.default_rng((1, 0)))
    track = Walker(world, PLACES[place].camera_habits, 1).advance(7200)
    camera = Camera(world, (640, 480), (textures, light), _EVERY * STEP_NS / 1e9, (1, 1))
    frames, counts = [], []
    for pose, motion in zip(track.poses[::_EVERY], track.motion[::_EVERY], strict=True):
        shot = camera.take(pose, float(motion[1]), None)
        quality = [cv2.IMWRITE_JPEG_QUALITY, camera.light.jpeg_quality]
        jpeg = cv2.imencode(".jpg", shot.image, quality)[1].tobytes()
        frames.append(Frame(0, "compressed", 0, 0, 0, jpeg))
        counts.append(material_counts(shot.labels))
    features = PatchEmbedder(ImageParams()).transform(frames).features
    shares = np.concatenate(counts) / np.concatenate(counts).sum(axis=1, keepdims=True)
    pure = shares.max(axis=1) >= 0.9
    return features.reshape(len(shares), -1)[pure], shares.argmax(axis=1)[pure]


@pytest.mark.slow
@pytest.mark.parametrize("textures", PALETTES)
@pytest.mark.parametrize(
    ("place", "light"), [("indoor", "day"), ("indoor", "evening"), ("outdoor", "day")]
)
def test_k_means_with_the_true_number_is_good_but_not_perfect(
    place: str, textures: str, light: str
) -> None:
    """Its V-measure is 0.5 to 0.97, and its clusters are mostly of one material."""
    features, materials = pure_patches(place, textures, light)
    k_means = KMeans(len(set(materials.tolist())), n_init=2, random_state=0)

    clusters = k_means.fit_predict(features)

    assert 0.5 <= v_measure_score(materials, clusters) <= 0.97
    assert homogeneity_score(materials, clusters) >= 0.8
