"""Collision models from features and labels that are ready, as experiments need them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mpap_cli.observations import FeatureBlock, Int8Array
from mpap_cli.params import Settings
from mpap_cli.properties.counts import count_labels
from mpap_cli.systems.collision import CollisionModel
from mpap_cli.systems.labelling import LogSource
from mpap_cli.systems.model_parts import new_parts


@dataclass(frozen=True, slots=True, eq=False)
class LabelledFeatures:
    """Observations of one log with their labels.

    ``labels`` (n, 3) int8 has the columns contact, onset, early: 1, 0, or -1 where there
    is none. The observations may be any part of the log, in time order.
    """

    features: FeatureBlock
    labels: Int8Array
    log_index: int = 0


def train(settings: Settings, logs: Sequence[LabelledFeatures]) -> CollisionModel:
    """Train a model on features and labels that are ready (sections 4.1 and 5.2).

    Parameters
    ----------
    settings : Settings
        Everything that can change the result.
    logs : sequence of LabelledFeatures
        At least one, in the order in which they are learnt; their features have one width.

    Returns
    -------
    CollisionModel
        Ready to predict, and the same as from replaying the logs. Its clusters know no
        visits, and its logs no name.

    Raises
    ------
    ValueError
        If there is nothing to learn from, since the width is unknown then.
    """
    if not logs:
        msg = "logs: found none, expected at least one to learn from"
        raise ValueError(msg)
    parts = new_parts(settings, logs[0].features.features.shape[1])
    for log in logs:
        block = log.features
        ids, _ = parts.meta_points.add_data_points(block.features, block.stamps_ns, log.log_index)
        count_labels(parts.meta_points, ids, log.labels)
    model = CollisionModel(settings, replace(parts, logs=_sources(logs)))
    model.recluster()
    return model


def _sources(logs: Sequence[LabelledFeatures]) -> tuple[LogSource, ...]:
    """Return a nameless source for every log index in use."""
    n_logs = max(log.log_index for log in logs) + 1
    sources = []
    for index in range(n_logs):
        stamps = [log.features.stamps_ns for log in logs if log.log_index == index]
        stamps_ns = np.concatenate([np.empty(0, dtype=np.int64), *stamps])
        first_ns = int(stamps_ns.min()) if stamps_ns.size else 0
        last_ns = int(stamps_ns.max()) if stamps_ns.size else 0
        sources.append(LogSource("", first_ns, last_ns, stamps_ns.size, None, "labels"))
    return tuple(sources)
