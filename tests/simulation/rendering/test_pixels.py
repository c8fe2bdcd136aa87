"""Noise and counts of pixels equal their plain numpy forms."""

import numpy as np
import pytest

from mpap_cli.simulation.rendering.pixels import _kernels


@pytest.fixture(params=[True, False], ids=["compiled", "plain"])
def kernels(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run the loops compiled, and as plain Python."""
    if not request.param:
        for name in ("_add_noise", "_count_cells"):
            monkeypatch.setattr(_kernels, name, getattr(_kernels, name).py_func)


@pytest.mark.usefixtures("kernels")
def test_noise_is_added_and_cut_off() -> None:
    """The ring goes around; sums stay within 0 and 255."""
    rng = np.random.default_rng(1)
    image = rng.integers(0, 256, (6, 7, 3)).astype(np.uint8)
    noise = rng.integers(-127, 128, 64).astype(np.int8)
    ring = noise[(50 + np.arange(image.size)) % 64].reshape(image.shape)
    expected = np.clip(image.astype(int) + ring, 0, 255)

    _kernels.add_noise(image, noise, 50)

    np.testing.assert_array_equal(image, expected)


@pytest.mark.usefixtures("kernels")
def test_pixels_are_counted_by_cell_and_label() -> None:
    """Each cell counts its own pixels; those outside of the grid are left out."""
    labels = np.random.default_rng(2).integers(0, 5, (20, 30)).astype(np.uint8)
    rows, columns = np.array([1, 7, 19]), np.array([0, 11, 20, 30])

    counts = _kernels.count_cells(labels, rows, columns, 5)

    cells = [
        labels[a:b, c:d] for a, b in ((1, 7), (7, 19)) for c, d in ((0, 11), (11, 20), (20, 30))
    ]
    expected = [np.bincount(cell.ravel(), minlength=5) for cell in cells]
    np.testing.assert_array_equal(counts, expected)
