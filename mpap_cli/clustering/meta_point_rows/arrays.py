"""What is known of meta-points, as arrays with one row each."""

import numpy as np

from mpap_cli.clustering.meta_point_rows.tables import (
    CLUSTER_POINT,
    DROPPED,
    N_DROPPED,
    N_ROWS,
    Rows,
    kept_rows,
)
from mpap_cli.observations import BoolArray, Float32Array, Float64Array, IntArray


class MetaPointArrays:
    """Arrays of the meta-points in the order in which they were made; all are copies."""

    _rows: Rows

    @property
    def n_points(self) -> int:
        """Meta-points of both kinds."""
        return len(kept_rows(self._rows))

    @property
    def n_dropped(self) -> int:
        """Noise-points that were forgotten, by age or by number."""
        return int(self._rows.totals[N_DROPPED])

    @property
    def ids(self) -> IntArray:
        """Ids (n,), ascending."""
        return self._rows.ids[kept_rows(self._rows)]

    @property
    def count(self) -> IntArray:
        """Points that each meta-point stands for (n,)."""
        return self._rows.point_count[kept_rows(self._rows)]

    @property
    def sums(self) -> Float64Array:
        """Sums of these points (n, d)."""
        return self._rows.sums[kept_rows(self._rows)]

    @property
    def exemplars(self) -> Float32Array:
        """Points kept as they came (n, d)."""
        return self._rows.exemplars[kept_rows(self._rows)]

    @property
    def exemplar_stamp_ns(self) -> IntArray:
        """Stamps of the exemplars (n,)."""
        return self._rows.exemplar_stamp_ns[kept_rows(self._rows)]

    @property
    def exemplar_log(self) -> IntArray:
        """Indices of the logs that the exemplars come from (n,)."""
        return self._rows.exemplar_log[kept_rows(self._rows)]

    @property
    def first_ns(self) -> IntArray:
        """Stamps of the points that made the meta-points (n,)."""
        return self._rows.first_ns[kept_rows(self._rows)]

    @property
    def last_ns(self) -> IntArray:
        """Stamps of the last updates (n,)."""
        return self._rows.last_ns[kept_rows(self._rows)]

    @property
    def is_cluster_point(self) -> BoolArray:
        """Whether each meta-point is a cluster-point (n,)."""
        is_cluster_point: BoolArray = self._rows.kind[kept_rows(self._rows)] == CLUSTER_POINT
        return is_cluster_point

    @property
    def counts(self) -> IntArray:
        """Label counts (n, 3, 2): pairs contact, onset, early; negative, positive."""
        return self._rows.label_counts[kept_rows(self._rows)]

    def references(self) -> Float64Array:
        """Return what distances go to (n, d): the means, or the exemplars."""
        return self._rows.references[kept_rows(self._rows)]

    def rows_of(self, ids: IntArray) -> IntArray:
        """Return the rows of these ids in the arrays, -1 where dropped or unknown."""
        known = self.ids
        if not known.size:
            return np.full(np.shape(ids), -1, np.int64)
        rows = np.minimum(np.searchsorted(known, ids), known.size - 1)
        return np.where(known[rows] == ids, rows, -1)

    def add_counts(self, ids: IntArray, pair: int, positive: BoolArray) -> None:
        """Count labels of points that joined these meta-points.

        Parameters
        ----------
        ids : ndarray of shape (m,)
            As returned by :meth:`add_data_points`; what was dropped since is left out.
        pair : int
            0 contact, 1 onset, 2 early.
        positive : ndarray of shape (m,)
            The labels.
        """
        rows = self._rows
        # dropped rows keep their ids until the tables are resized, so all of them ascend
        used = rows.ids[: rows.totals[N_ROWS]]
        if not used.size:
            return
        at = np.minimum(np.searchsorted(used, ids), used.size - 1)
        known = (used[at] == ids) & (rows.kind[at] != DROPPED)
        np.add.at(rows.label_counts, (at[known], pair, positive[known].astype(np.int64)), 1)
