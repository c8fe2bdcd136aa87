"""Which patches are obstacles: their nearest exemplars tell (section 4.2.5)."""

import math
from dataclasses import dataclass

import numpy as np

from mpap_cli.clustering.two_scale import TwoScale
from mpap_cli.observations import (
    BoolArray,
    Float32Array,
    Float64Array,
    IntArray,
    PatchPrediction,
)
from mpap_cli.params import Settings
from mpap_cli.properties.counts import ClusteredPoints, ratio
from mpap_cli.properties.kernel import Kernel, mean_of_counts
from mpap_cli.properties.obstacle_evidence import weigh_labels
from mpap_cli.systems.nearest import nearest_exemplars


@dataclass(frozen=True, slots=True, eq=False)
class KnownExemplars:
    """What a model can explain, as it stood at one moment.

    ``features`` (f, d) are its exemplars, of length 1; ``eps`` is the fit radius.
    """

    features: Float32Array
    eps: float

    def unknown(self, features: Float32Array) -> BoolArray:
        """Tell which patches or scans no exemplar explains.

        Parameters
        ----------
        features : ndarray of shape (..., d)
            Embedded patches or scans, of length 1.

        Returns
        -------
        ndarray of shape (...)
            True where the nearest exemplar is not within the fit radius, or there is none.

        Examples
        --------
        >>> known = KnownExemplars(np.eye(3, dtype=np.float32)[:2], eps=0.5)
        >>> known.unknown(np.eye(3, dtype=np.float32)).tolist()
        [False, False, True]
        """
        _, squared = nearest_exemplars(_rows(features), self.features, 1)
        return self.beyond(squared[:, 0]).reshape(features.shape[:-1])

    def beyond(self, squared: Float64Array) -> BoolArray:
        """Tell which squared distances are not within the fit radius."""
        return ~(squared < self.eps**2)


@dataclass(frozen=True, slots=True, eq=False)
class PatchClassifier:
    """The k-nearest neighbor classifier over exemplars (section 4.2.5).

    ``cluster`` (f,) int64 is -1 for exemplars that are in no coarse cluster;
    ``p_obstacle`` (f,) float64 is NaN everywhere if nothing is labelled. With a ``kernel``
    the ``evidence`` (f, 2) against and for an obstacle is read instead, and the
    ``base_rate``, which is NaN then.
    """

    known: KnownExemplars
    cluster: IntArray
    p_obstacle: Float64Array
    evidence: Float64Array
    base_rate: float
    neighbors: int
    kernel: Kernel | None = None

    def classify(self, features: Float32Array) -> PatchPrediction:
        """Classify the patches of images by their nearest exemplars.

        Parameters
        ----------
        features : ndarray of shape (n, n_patches, d)
            Embedded patches.

        Returns
        -------
        PatchPrediction
            Of several neighbors the mean of their probabilities, weighted by 1 / distance
            (those at distance 0 alone, if there are any), or what the kernel makes of
            their evidence; cluster and distance are always those of the nearest. Without
            exemplars the cluster is -1 and the distance infinite.
        """
        shape = features.shape[:2]
        rows, squared = nearest_exemplars(_rows(features), self.known.features, self.neighbors)
        return PatchPrediction(
            cluster=np.append(self.cluster, -1)[rows[:, 0]].reshape(shape),
            distance=np.sqrt(squared[:, 0]).reshape(shape),
            unknown=self.known.beyond(squared[:, 0]).reshape(shape),
            p_obstacle=self._read(rows, squared).reshape(shape),
        )

    def _read(self, rows: IntArray, squared: Float64Array) -> Float64Array:
        """Read the probability of each patch off its neighbors (m, k)."""
        if self.kernel is not None:
            evidence = np.append(self.evidence, [[0.0, 0.0]], axis=0)[rows]
            return mean_of_counts(squared, evidence, self.base_rate, self.kernel)
        p: Float64Array = np.append(self.p_obstacle, np.nan)[rows]
        return p[:, 0] if p.shape[1] == 1 else _weighted_mean(p, np.sqrt(squared))


def known_patches(two_scale: TwoScale) -> KnownExemplars:
    """Return what a model can explain now, long-term and short-term; a copy."""
    return KnownExemplars(two_scale.fine().features.copy(), two_scale.strap.eps)


def patch_classifier(
    two_scale: TwoScale, coarse: ClusteredPoints, settings: Settings
) -> PatchClassifier:
    """Build the classifier out of the exemplars of both time scales.

    Parameters
    ----------
    two_scale : TwoScale
        Exemplars with counted labels.
    coarse : ClusteredPoints
        Clusters of its long-term exemplars.
    settings : Settings
        ``neighbors`` exemplars are asked, ``readout`` says for what.

    Returns
    -------
    PatchClassifier
        The probability of a long-term exemplar is that of its coarse cluster (equation 8).
        A short-term one has its own counts; without any the probability of the nearest
        long-term one. The share of obstacles over all exemplars stands in where nothing
        is counted. Readout ``metapoint`` reads the counts of each exemplar with some
        pseudo-counts at that probability, ``kernel`` the evidence of all neighbors
        (:func:`~mpap_cli.properties.obstacle_evidence.weigh_labels`), each weighing
        exp(-2 d^2 / eps^2), with some pseudo-counts at the base rate.

    Notes
    -----
    Equation 8 over coarse clusters is the paper's, and the best where every patch of other
    images counts as no obstacle. With labels of driven floor the kernel tells more: a
    coarse cluster that has swallowed a floor and a wall says the same of both.
    """
    params, fine = settings.properties, two_scale.fine()
    p = _probabilities(two_scale, coarse)
    if params.readout == "metapoint":
        prior = params.metapoint_prior
        total = fine.labels.sum(axis=1) + prior
        own = fine.labels[:, 1] + prior * p
        p = np.where(total > 0, own / np.where(total > 0, total, 1.0), p)
    n_short = int(fine.is_short.sum())
    neighbors, eps = settings.obstacle.neighbors, two_scale.strap.eps
    kernel = Kernel(eps / 2, neighbors, settings.obstacle.patch_prior)
    touched = bool(fine.labels[:, 1].any())  # without a press, nothing is known of obstacles
    sighting_weight = settings.obstacle.sighting_weight if touched else 0.0
    evidence = weigh_labels(fine.labels, fine.count, sighting_weight)
    against, speaking = evidence.sum(axis=0).tolist()
    return PatchClassifier(
        known=KnownExemplars(fine.features, eps),
        cluster=np.append(coarse.clustering.labels, np.full(n_short, -1)),
        p_obstacle=p,
        evidence=evidence,
        base_rate=speaking / (against + speaking) if fine.labels.any() else math.nan,
        neighbors=neighbors,
        kernel=kernel if params.readout == "kernel" else None,
    )


def cluster_p_obstacle(
    two_scale: TwoScale, coarse: ClusteredPoints, settings: Settings
) -> Float64Array:
    """Return the probability of each coarse cluster, in agreement with that of patches.

    Returns
    -------
    ndarray of shape (k,)
        Readout ``kernel``: what a patch like the exemplars of the cluster is given, the
        mean over the patches that these stand for. Else the share of equation 8, NaN where
        nothing is counted.
    """
    if settings.properties.readout != "kernel":
        return ratio(coarse_counts(two_scale, coarse))
    labels, exemplars = coarse.clustering.labels, two_scale.fine().features[: two_scale.n_clusters]
    p = patch_classifier(two_scale, coarse, settings).classify(exemplars[None]).p_obstacle[0]
    weight = np.bincount(labels, two_scale.count, coarse.n_clusters)
    mean: Float64Array = np.bincount(labels, two_scale.count * p, coarse.n_clusters) / weight
    return mean


def coarse_counts(two_scale: TwoScale, coarse: ClusteredPoints) -> IntArray:
    """Sum the labels of each coarse cluster over its exemplars: (k, 2), negative, positive."""
    counts = np.zeros((coarse.n_clusters, 2), dtype=np.int64)
    np.add.at(counts, coarse.clustering.labels, two_scale.labels)
    return counts


def _probabilities(two_scale: TwoScale, coarse: ClusteredPoints) -> Float64Array:
    """Return the probability of each exemplar of both time scales (equation 8)."""
    fine = two_scale.fine()
    shares = ratio(coarse_counts(two_scale, coarse))[coarse.clustering.labels]
    p = np.append(shares, ratio(fine.labels[fine.is_short]))
    bare = np.flatnonzero(np.isnan(p) & fine.is_short)
    if shares.size and bare.size:
        rows, _ = nearest_exemplars(fine.features[bare], fine.features[: shares.size], 1)
        p[bare] = shares[rows[:, 0]]
    base_rate = float(ratio(fine.labels.sum(axis=0)))
    return np.where(np.isnan(p), base_rate, p)


def _weighted_mean(p: Float64Array, distance: Float64Array) -> Float64Array:
    """Average each row (m, k) by 1 / distance; what is at distance 0 counts alone."""
    same = distance == 0
    weights = np.where(same.any(axis=1, keepdims=True), same, 1.0 / np.where(same, 1.0, distance))
    mean: Float64Array = (weights * p).sum(axis=1) / weights.sum(axis=1)
    return mean


def _rows(features: Float32Array) -> Float32Array:
    """Return patches (..., d) as one row each."""
    return np.ascontiguousarray(features, dtype=np.float32).reshape(-1, features.shape[-1])
