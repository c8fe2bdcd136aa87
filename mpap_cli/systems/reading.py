"""What a collision model tells without learning: predictions, clusters, a check of theta."""

from dataclasses import dataclass, replace

import numpy as np

from mpap_cli.classifier import classify
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.observations import Float32Array, Prediction
from mpap_cli.properties.contact_map import ContactMap, fit_contact_map
from mpap_cli.properties.counts import cluster_counts, ratio
from mpap_cli.properties.labels import CONTACT, ONSET
from mpap_cli.systems.cluster_rows import cluster_probabilities, pair_of
from mpap_cli.systems.model_parts import ModelParts

_MOST_FITTED = 2000
_FEW_CLUSTER_POINTS = 20
_MUCH_NOISE = 0.5


@dataclass(frozen=True, slots=True)
class SelfCheck:
    """Whether theta suits the data (section 3.4): how much ended in noise-points."""

    n_cluster_points: int
    noise_share: float

    @property
    def theta_too_large(self) -> bool:
        """Fewer than 20 cluster-points: affinity propagation finds too few clusters."""
        return self.n_cluster_points < _FEW_CLUSTER_POINTS

    @property
    def theta_too_small(self) -> bool:
        """More than half of the observations are in noise-points."""
        return self.noise_share > _MUCH_NOISE


def check_theta(meta_points: MetaPoints) -> SelfCheck:
    """Tell how much ended in cluster-points and how much in noise-points."""
    is_cluster_point = meta_points.is_cluster_point
    n_cluster_points = int(is_cluster_point.sum())
    total = int(meta_points.count.sum())
    noise = int(meta_points.count[~is_cluster_point].sum())
    return SelfCheck(n_cluster_points, noise / max(total, 1))


def predict(parts: ModelParts, features: Float32Array, target: str) -> Prediction:
    """Tell what a model says of observations (section 2.4).

    Parameters
    ----------
    parts : ModelParts
        The model.
    features : ndarray of shape (n, d)
        Embedded observations, as the model's settings make them.
    target : str
        ``contact``, ``onset`` or ``early``.

    Returns
    -------
    Prediction
        ``p_cluster`` is the cluster's probability as clusters.csv shows it (the base rate
        where the cluster has no label), ``p_collision`` the read-out. Where onsets are
        learnt, ``contact`` goes through the map to contacts.
    """
    pair = pair_of(parts.settings, target)
    points, clustered = parts.meta_points, parts.clustered
    found = classify(points, clustered, parts.settings.properties, pair, features)
    counts = cluster_counts(points, clustered, pair)
    shown = cluster_probabilities(counts, parts.settings.profile)
    base_rate = ratio(points.counts[:, pair].sum(axis=0))
    p_cluster = np.append(np.where(np.isnan(shown), base_rate, shown), base_rate)
    contact = target == "contact" and pair == ONSET
    contact_map = parts.contact_map if contact else ContactMap()
    return replace(
        found,
        p_cluster=p_cluster[found.cluster],
        p_collision=contact_map.apply(found.p_collision),
    )


def contact_map_of(parts: ModelParts) -> ContactMap:
    """Fit the map from onsets to contacts on the counts of the meta-points.

    The meta-points with the most contact labels are taken; a model that learns contacts
    themselves needs no map.
    """
    if pair_of(parts.settings, "contact") != ONSET:
        return ContactMap()
    counts = parts.meta_points.counts[:, CONTACT]
    rows = np.argsort(-counts.sum(axis=1), kind="stable")[:_MOST_FITTED]
    at = parts.meta_points.references()[rows]
    params = parts.settings.properties
    read = classify(parts.meta_points, parts.clustered, params, ONSET, at)
    return fit_contact_map(read.p_collision, counts[rows])
