"""What a collision model tells without learning: predictions, clusters, a check of theta."""

from dataclasses import dataclass, replace

import numpy as np

from mpap_cli.classifier import classify
from mpap_cli.clustering.meta_points import MetaPoints
from mpap_cli.features.scans.histograms import range_columns
from mpap_cli.observations import Float32Array, Float64Array, FloatArray, IntArray, Prediction
from mpap_cli.params import TARGETS
from mpap_cli.properties.alarms import alarm_odds, odds_of
from mpap_cli.properties.contact_map import ContactMap, fit_contact_map
from mpap_cli.properties.counts import cluster_counts, ratio
from mpap_cli.properties.kernel import Kernel
from mpap_cli.properties.labels import CONTACT, ONSET
from mpap_cli.properties.range_curves import block_angles, join, read_range_curve
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
        learnt, ``contact`` goes through the map to contacts, but ``alarm`` is that of onsets.
    """
    pair = pair_of(parts.settings, target)
    points, clustered = parts.meta_points, parts.clustered
    found = _read(parts, pair, features)
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
        alarm=odds_of(found.p_collision) / parts.alarm_odds[pair],
    )


def fit_reading(parts: ModelParts) -> ModelParts:
    """Fit the map to contacts, and the odds from which alarms begin, to what was counted."""
    return replace(parts, contact_map=contact_map_of(parts), alarm_odds=alarm_odds_of(parts))


def contact_map_of(parts: ModelParts) -> ContactMap:
    """Fit the map from onsets to contacts on the counts of the meta-points.

    A model that learns contacts themselves needs no map.
    """
    if pair_of(parts.settings, "contact") != ONSET:
        return ContactMap()
    read, counts = _read_back(parts, ONSET, CONTACT)
    return fit_contact_map(read, counts)


def alarm_odds_of(parts: ModelParts) -> Float64Array:
    """Return the odds (3,) of each pair of counts from which an alarm begins.

    NaN under profile paper, and where nothing can be told.
    """
    if parts.settings.profile != "robust":
        return np.full(len(TARGETS), np.nan)
    params = parts.settings.properties
    odds = [alarm_odds(*_read_back(parts, pair, pair), params) for pair in range(len(TARGETS))]
    return np.array(odds, dtype=np.float64)


def _read_back(parts: ModelParts, pair: int, counted: int) -> tuple[Float64Array, IntArray]:
    """Read a pair of counts at the meta-points, with what was ``counted`` there of a pair.

    The meta-points with the most labels are taken.
    """
    counts = parts.meta_points.counts[:, counted]
    rows = np.argsort(-counts.sum(axis=1), kind="stable")[:_MOST_FITTED]
    at = parts.meta_points.references()[rows]
    return _read(parts, pair, at).p_collision, counts[rows]


def _read(parts: ModelParts, pair: int, features: FloatArray) -> Prediction:
    """Classify observations, and join the curves over the nearest ranges to the kernel."""
    params, points = parts.settings.properties, parts.meta_points
    found = classify(points, parts.clustered, params, pair, features)
    columns = range_columns(parts.settings.scan) if params.readout == "kernel" else ()
    base_rate = float(ratio(points.counts[:, pair].sum(axis=0)))
    if not columns or params.range_share == 0 or not 0 < base_rate < 1:
        return found
    kernel = Kernel(points.params.theta, params.kernel_k, params.prior_counts)
    references, counts = points.references(), points.counts[:, pair]
    curves = [
        read_range_curve(
            block_angles(features, column),
            block_angles(references, column),
            counts,
            base_rate,
            kernel,
        )
        for column in columns
    ]
    return replace(found, p_collision=join(found.p_collision, curves, params.range_share))
