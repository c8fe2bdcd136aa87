"""Predictions of one grid brought to another."""

import numpy as np
import pytest

from mpap_cli.evaluation.patch_grids import regrid
from mpap_cli.evaluation.patch_truth import PatchPlaces, SeenPatches


def seen(p: list[list[list[float]]], *, shuffled: bool = False) -> SeenPatches:
    """Return patches with these probabilities (images, rows, columns), unknown above one half."""
    values = np.array(p)
    image, row, column = (axis.ravel() for axis in np.indices(values.shape))
    order = (
        np.random.default_rng(0).permutation(values.size) if shuffled else np.arange(values.size)
    )
    p_flat = values.ravel()[order]
    places = PatchPlaces(image[order] + 100, row[order], column[order])
    return SeenPatches(places, (10 * p_flat).astype(np.int64), p_flat, p_flat > 0.5)


def test_the_same_grid_is_the_same() -> None:
    """Patches come back in order of stamps, rows and columns, whatever their order was."""
    p = [[[0.1, 0.2], [0.3, 0.9]], [[0.5, 0.6], [0.7, 0.8]]]

    same = regrid(seen(p, shuffled=True), (2, 2), (2, 2))

    assert same.p_obstacle.tolist() == np.ravel(p).tolist()
    assert same.places.stamps_ns.tolist() == [100] * 4 + [101] * 4
    assert same.places.rows.tolist() == [0, 0, 1, 1] * 2
    assert same.unknown.tolist() == [False, False, False, True, False, True, True, True]


def test_patches_are_joined_by_their_mean() -> None:
    """Four columns become two; half of the parts unknown is unknown."""
    joined = regrid(seen([[[0.2, 0.4, 0.4, 0.8]]]), (1, 4), (1, 2))

    np.testing.assert_allclose(joined.p_obstacle, [0.3, 0.6])
    assert joined.unknown.tolist() == [False, True]
    assert joined.cluster.tolist() == [2, 4]


def test_a_patch_is_divided_into_equal_parts() -> None:
    """Each part says what the whole said, and lies where the whole lay."""
    divided = regrid(seen([[[0.2, 0.8]]]), (1, 2), (2, 4))

    assert divided.p_obstacle.reshape(2, 4).tolist() == [[0.2, 0.2, 0.8, 0.8]] * 2
    assert divided.places.columns.tolist() == [0, 1, 2, 3] * 2


def test_rows_may_be_joined_while_columns_are_divided() -> None:
    """Each side has its own way."""
    changed = regrid(seen([[[0.2], [0.4]]]), (2, 1), (1, 3))

    np.testing.assert_allclose(changed.p_obstacle, [0.3] * 3)


def test_sides_that_do_not_fit_are_refused() -> None:
    """Six columns cannot be brought to four."""
    with pytest.raises(ValueError, match="cannot be brought"):
        regrid(seen([[[0.1] * 6]]), (1, 6), (1, 4))
