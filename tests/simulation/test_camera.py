"""The camera shows what is ahead, by light, and what touches the robot."""

import dataclasses

import numpy as np
import pytest

from mpap_cli.observations import Float64Array
from mpap_cli.simulation.camera import Camera, Shot
from mpap_cli.simulation.lights import LIGHTS
from mpap_cli.simulation.palettes import NAMES, PALETTES
from mpap_cli.simulation.world import World, WorldBuilder

SIZE = (160, 120)
FAR = np.array((-1.5, 0.0, 0.0))


@pytest.fixture(scope="module")
def world() -> World:
    """Return a room of 4 x 3 m with a high box in the middle."""
    builder = WorldBuilder(np.random.default_rng(1))
    builder.add_line("wall", [(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5), (-2, -1.5)])
    builder.add_box("shelf", (1.0, 0.0), (0.6, 0.6))
    return builder.build((-1, -1, 0, 1))


def make_camera(world: World, light: str = "day", textures: str = "a") -> Camera:
    """Return a camera of five images a second."""
    return Camera(world, SIZE, (textures, light), 0.2, (1, 2))


def seen(shot: Shot) -> dict[str, float]:
    """Return the share of pixels of each material in the image."""
    shares = np.bincount(shot.labels.ravel(), minlength=len(NAMES)) / shot.labels.size
    return {name: float(share) for name, share in zip(NAMES, shares, strict=True) if share}


def take(camera: Camera, *pose: float) -> Shot:
    """Take an image from a place, standing still."""
    return camera.take(np.array(pose), 0.0, None)


def test_same_seeds_same_images(world: World) -> None:
    """Two cameras of the same seeds take the same row of images."""
    cameras = [make_camera(world), make_camera(world)]

    rows = [[take(camera, *FAR).image.tobytes() for _ in range(3)] for camera in cameras]

    assert rows[0] == rows[1]
    assert len(set(rows[0])) == 3


@pytest.mark.parametrize("pose", [(0.5, 0.0, 0.0), (1.8, 0.9, 0.0)], ids=["box", "wall"])
def test_image_is_full_of_what_is_touched(world: World, pose: tuple[float, float, float]) -> None:
    """With its front at a high thing the robot sees nothing else."""
    shot = take(make_camera(world), *pose)

    assert seen(shot) == {"shelf" if pose[1] == 0 else "wall": 1.0}


def test_floor_begins_at_the_bottom_and_ends_below_the_horizon(world: World) -> None:
    """From afar the bottom is floor, the top wall and shelf; nearer things are lower down."""
    labels = take(make_camera(world), *FAR).labels

    assert set(labels[-1]) <= {0, 1}
    assert {NAMES[label] for label in labels[0]} == {"wall", "shelf"}
    foot_of_shelf = np.nonzero(labels[:, SIZE[0] // 2] == NAMES.index("shelf"))[0].max()
    foot_of_wall = np.nonzero(labels == NAMES.index("wall"))[0].min()
    assert foot_of_shelf > foot_of_wall


def test_foot_is_drawn_while_it_presses(world: World) -> None:
    """A foot ahead stands in the image, one at the side does not; another image has none."""
    camera = make_camera(world)

    shots = [camera.take(FAR, 0.0, foot_rad) for foot_rad in (0.0, 1.2, None)]

    shares = [seen(shot).get("foot", 0.0) for shot in shots]
    assert shares[0] > 0.15
    assert shares[1:] == [0.0, 0.0]
    ahead = shots[0].labels[:, SIZE[0] // 2 - 5 : SIZE[0] // 2 + 5]
    assert (ahead == NAMES.index("foot")).mean() > 0.7


def test_turning_smears_the_image_sideways(world: World) -> None:
    """Edges across the turn fade when the robot turns fast in the evening."""
    still, turning = (
        make_camera(world, "evening").take(FAR, turn, None).image.astype(float)
        for turn in (0.0, 3.0)
    )

    def edges(image: Float64Array) -> float:
        return float(np.abs(np.diff(image[:, :, 1], axis=1)).mean())

    assert edges(turning) < 0.9 * edges(still)


@pytest.mark.parametrize("textures", PALETTES)
def test_evening_is_another_light(world: World, textures: str) -> None:
    """In the evening things stand where they stood; the image is darker or brighter."""
    day, evening = (make_camera(world, light, textures) for light in ("day", "evening"))

    shots = [take(camera, *FAR) for camera in (day, evening)]

    np.testing.assert_array_equal(shots[0].labels, shots[1].labels)
    means = [shot.image.mean(axis=(0, 1)) for shot in shots]
    assert np.abs(means[0] - means[1]).max() > 5
    assert all(40 < mean.mean() < 200 for mean in means)


def test_dusk_is_a_warmer_evening(world: World) -> None:
    """Its camera balances white less, so that red outweighs blue more than in the evening."""
    evening, dusk = (take(make_camera(world, light, "a"), *FAR) for light in ("evening", "dusk"))

    ratio = [shot.image[..., 2].mean() / shot.image[..., 0].mean() for shot in (evening, dusk)]
    assert ratio[1] > 1.05 * ratio[0]


def test_evening_changes_light_and_camera() -> None:
    """Color, brightness and side of the light are others, and every setting of the camera."""
    day, evening = (dataclasses.asdict(LIGHTS[name]) for name in ("day", "evening"))

    same = {name for name, value in day.items() if evening[name] == value}

    assert same == set()


def test_images_are_well_exposed(world: World) -> None:
    """Hardly a pixel is black or white."""
    camera = make_camera(world)

    images = [take(camera, -1.0, -0.5, turn).image for turn in (0.0, 1.5, 3.0, 4.5)]

    assert np.mean([(image == 0).mean() for image in images]) < 0.01
    assert np.mean([(image == 255).mean() for image in images]) < 0.01
