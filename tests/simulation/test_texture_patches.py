"""Labelled patches of procedural surfaces."""

import numpy as np

from mpap_cli.simulation.texture_patches import SURFACES, texture_patches


def test_there_are_equally_many_of_six_classes() -> None:
    """1,200 patches by default would be 200 of each; here 10."""
    made = texture_patches(seed=1, n_a_class=10)

    assert made.patches.shape == (60, 40, 52, 3)
    assert made.patches.dtype == np.uint8
    assert np.bincount(made.classes).tolist() == [10] * 6
    assert made.class_names == tuple(SURFACES)


def test_a_seed_gives_the_same_patches_and_another_does_not() -> None:
    """Everything is left to the seed."""
    one, again, other = (texture_patches(seed=seed, n_a_class=2).patches for seed in (3, 3, 4))

    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


def test_no_two_patches_are_alike() -> None:
    """Each is a cut of its own."""
    patches = texture_patches(seed=0, n_a_class=6).patches

    assert len({patch.tobytes() for patch in patches}) == len(patches)


def test_classes_differ_in_color() -> None:
    """Grass is green, brick is red, asphalt is gray."""
    made = texture_patches(seed=0, n_a_class=10)

    means = {
        name: made.patches[made.classes == number].mean(axis=(0, 1, 2))
        for number, name in enumerate(made.class_names)
    }

    assert means["grass"].argmax() == 1
    assert means["brick"].argmax() == 2
    assert np.ptp(means["asphalt"]) < 15
