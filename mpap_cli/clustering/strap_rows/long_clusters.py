"""What is known of long-term clusters, as arrays with one row each."""

from mpap_cli.clustering.strap import Strap
from mpap_cli.observations import Float32Array, Float64Array, IntArray


class LongClusters:
    """Arrays of the long-term clusters, ids ascending; all are copies."""

    _long: Strap

    @property
    def n_clusters(self) -> int:
        """Long-term clusters."""
        return self._long.clusters.n_items

    @property
    def n_reservoir(self) -> int:
        """Outliers that wait for a rebuild."""
        return self._long.n_reservoir

    @property
    def n_outliers_ever(self) -> int:
        """Observations that fitted no cluster at their arrival."""
        return self._long.n_outliers_ever

    @property
    def n_rebuilds(self) -> int:
        """How often the clusters were made anew."""
        return self._long.n_rebuilds

    @property
    def ids(self) -> IntArray:
        """Ids (k,), ascending."""
        return self._long.clusters.ids.copy()

    @property
    def exemplars(self) -> Float32Array:
        """Observations kept as they came (k, d)."""
        return self._long.clusters.exemplars.copy()

    @property
    def count(self) -> IntArray:
        """Observations that each cluster stands for (k,)."""
        return self._long.clusters.counts.copy()

    @property
    def weight(self) -> Float64Array:
        """Those of them that fitted or were there at a rebuild, as the window fades it (k,)."""
        return self._long.clusters.weight.copy()

    @property
    def distortion(self) -> Float64Array:
        """Sums of squared distances of these observations to the exemplars (k,)."""
        return self._long.clusters.distortion.copy()

    @property
    def first_ns(self) -> IntArray:
        """Smallest stamp of an observation (k,)."""
        return self._long.clusters.first_ns.copy()

    @property
    def last_ns(self) -> IntArray:
        """Stamps of the last updates (k,)."""
        return self._long.clusters.last_ns.copy()

    @property
    def exemplar_stamp_ns(self) -> IntArray:
        """Stamps of the exemplars (k,)."""
        return self._long.clusters.exemplar_stamp_ns.copy()

    @property
    def exemplar_log(self) -> IntArray:
        """Indices of the logs that the exemplars come from (k,)."""
        return self._long.clusters.exemplar_log.copy()

    @property
    def exemplar_patch(self) -> IntArray:
        """Where in their images the exemplars were (k,)."""
        return self._long.clusters.exemplar_patch.copy()

    @property
    def labels(self) -> IntArray:
        """Label counts (k, 2): negative, positive."""
        return self._long.clusters.labels.copy()
