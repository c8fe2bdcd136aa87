"""What speaks for and against an obstacle where patches look alike (sections 4.2.4 and 4.2.5)."""

import numpy as np

from mpap_cli.observations import Float64Array, IntArray


def weigh_labels(labels: IntArray, count: IntArray, sighting_weight: float) -> Float64Array:
    """Weigh what speaks against and for an obstacle at each exemplar.

    Parameters
    ----------
    labels : ndarray of shape (f, 2)
        Negative (driven floor) and positive (press).
    count : ndarray of shape (f,)
        Patches that each exemplar stands for, with a label or without.
    sighting_weight : float
        What a patch without label weighs, as a share of a label.

    Returns
    -------
    ndarray of shape (f, 2)
        Against: the negative labels. For: the positive ones and some of each patch without
        label, both times their share of all that speaks at the exemplar.

    Notes
    -----
    Floor is driven over again and again; what is often seen and never driven over is no
    floor, even if nothing ever touched it. And an image of a press shows floor too, so its
    labels count as far as nothing speaks against them: one step of expectation and
    maximization over images of which only some patches are obstacles.

    Examples
    --------
    >>> labels = np.array([[90, 5], [0, 0]])
    >>> weigh_labels(labels, np.array([195, 100]), 0.05).tolist()
    [[90.0, 1.0], [0.0, 5.0]]
    """
    negative, positive = labels[:, 0].astype(np.float64), labels[:, 1]
    bare = np.maximum(count - labels.sum(axis=1), 0)
    speaking = positive + sighting_weight * bare
    total = negative + speaking
    share = np.divide(speaking, total, out=np.zeros_like(total), where=total > 0)
    return np.stack([negative, speaking * share], axis=1)
