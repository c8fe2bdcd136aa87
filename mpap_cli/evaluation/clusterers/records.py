"""What every clusterer takes and gives, so that one experiment can run them all (section 5.1)."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from mpap_cli.observations import Float32Array, IntArray
from mpap_cli.params import AffinityParams, MetaPointParams, StrapParams

UNASSIGNED = -1
"""Label of a point that a clusterer calls noise, and class of a point that belongs to none."""

Value = TypeVar("Value")


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LabelledPoints:
    """Points and the classes they belong to.

    ``features`` (n, d) float32 are embedded histograms, at the distances of equation 7, if
    ``normalized``, else any points at Euclidean distances; ``classes`` (n,) int64 counts from
    0, and -1 marks noise, which takes part in the clustering but not in the scores.
    """

    features: Float32Array
    classes: IntArray
    normalized: bool = True

    def in_order(self, order: IntArray) -> "LabelledPoints":
        """Return the points in another order, (n,) row numbers."""
        return replace(self, features=self.features[order], classes=self.classes[order])

    @property
    def n_classes(self) -> int:
        """Number of different classes, noise left out."""
        return len(np.unique(self.classes[self.classes >= 0]))


@dataclass(frozen=True, slots=True, kw_only=True)
class ClustererSettings:
    """Settings of the clusterers that are ours; the defaults are for image patches.

    ``meta_point.theta`` is a distance: set it for points that are no embedded histograms
    (0.7 standard deviations of a cluster). With ``theta_from_points`` it is not looked at,
    theta comes from the points themselves; that makes sense for embedded histograms only.
    """

    meta_point: MetaPointParams = field(
        default_factory=lambda: MetaPointParams(theta=0.13, min_points=5)
    )
    affinity: AffinityParams = field(default_factory=lambda: AffinityParams(preference="median"))
    strap: StrapParams = field(default_factory=lambda: StrapParams(eps=0.18))
    theta_from_points: bool = False


PATCH_SETTINGS = ClustererSettings(
    meta_point=MetaPointParams(theta=0.13, min_points=4, exemplar="closest"),
    theta_from_points=True,
)
"""What image patches are clustered with unless something else is set.

The paper's 5 points and first exemplars gave a V-measure lower by 0.02 on average, and one
that depended more on the order, on 13 sets of photographs and rendered surfaces.
"""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ClusteringResult:
    """Clusters of n points.

    ``labels`` (n,) int64 count from 0, -1 where the clusterer calls a point noise;
    ``clustered_points`` is how many points were left to cluster after they had been
    summarized (cluster-points, exemplars, micro-clusters), None where nothing is;
    ``coverage`` is the share of points that belong to one of these (that are not noise);
    ``seconds`` is the processor time of the clusterer alone; ``exemplars`` (clusters,) are
    the rows of the exemplars, None where clusters have none; ``converged`` tells whether
    affinity propagation did, where there is any.
    """

    labels: IntArray
    clusters: int
    clustered_points: int | None
    coverage: float | None
    seconds: float
    exemplars: IntArray | None = None
    converged: bool = True


Run = Callable[[LabelledPoints, ClustererSettings, int], ClusteringResult]
"""Points in the order in which they come, settings, and a seed for what is random."""


@dataclass(frozen=True, slots=True)
class Clusterer:
    """A clusterer: its run, what its result depends on, and what it can take.

    ``varies``: with the order of the points or the seed. ``most_points``: more are too many,
    since it takes memory or time by the square of the points. ``needs``: the package that it
    comes with, where that need not be installed.
    """

    run: Run
    varies: bool = True
    most_points: int | None = None
    needs: str | None = None


def timed(work: Callable[[], Value]) -> tuple[Value, float]:
    """Return what work gives, and the seconds of processor time it took."""
    begin = time.process_time()
    value = work()
    return value, time.process_time() - begin
