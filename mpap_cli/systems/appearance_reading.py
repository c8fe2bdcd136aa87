"""What an appearance model tells without learning: predictions, clusters, pictures."""

from dataclasses import replace

from mpap_cli.clustering.two_scale import TwoScale
from mpap_cli.observations import PatchBlock, PatchPrediction
from mpap_cli.params import Settings
from mpap_cli.properties.visits import Visits, VisitSpool
from mpap_cli.systems.appearance_parts import AppearanceParts, cluster_coarsely, pack
from mpap_cli.systems.cluster_rows import ClusterRow
from mpap_cli.systems.discrepancy import find_discrepancies
from mpap_cli.systems.labelling import LogSource
from mpap_cli.systems.model_parts import CarriedVisits, ModelState
from mpap_cli.systems.obstacles import KnownExemplars, known_patches, patch_classifier
from mpap_cli.systems.patch_rows import ClusterPictures, find_pictures, make_patch_rows


class LearntAppearance:
    """Clusters of image patches, and what they tell of images.

    Parameters
    ----------
    parts : AppearanceParts
        What is known; not copied.
    """

    def __init__(self, parts: AppearanceParts) -> None:
        self._known = parts
        self._spool = VisitSpool()

    @property
    def settings(self) -> Settings:
        """Settings it was made with."""
        return self._known.settings

    @property
    def two_scale(self) -> TwoScale:
        """Exemplars with their counts (Algorithm 2)."""
        return self._known.two_scale

    @property
    def logs(self) -> tuple[LogSource, ...]:
        """Logs that were learnt, in their order."""
        return self._known.logs

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of patches."""
        return self.settings.image.rows_columns()

    @property
    def n_patches(self) -> int:
        """Patches of an image."""
        rows, columns = self.shape
        return rows * columns

    @property
    def n_images(self) -> int:
        """Images that were learnt."""
        return sum(log.n_observations for log in self.logs)

    def predict(self, block: PatchBlock) -> PatchPrediction:
        """Tell what the model says of patches (section 4.2.5).

        Parameters
        ----------
        block : PatchBlock
            Of n images.

        Returns
        -------
        PatchPrediction
            As :func:`patch_classifier` and :meth:`PatchClassifier.classify` say.
        """
        coarse = self._clustered().coarse
        return patch_classifier(self.two_scale, coarse, self.settings).classify(block.features)

    def known(self) -> KnownExemplars:
        """Return what the model can explain as it stands now; later learning changes nothing."""
        return known_patches(self.two_scale)

    def rows(self) -> list[ClusterRow]:
        """Describe the coarse clusters: the rows of clusters.csv."""
        return make_patch_rows(self._clustered(), self._visits())

    def discrepancies(self) -> list[ClusterRow]:
        """Find the clusters that are an obstacle at one time and none at another."""
        return find_discrepancies(self.rows())

    def pictures(self) -> list[ClusterPictures]:
        """Tell where the exemplar and members of each coarse cluster are found."""
        return find_pictures(self._clustered(), self.rows())

    def parts(self) -> AppearanceParts:
        """Return what the model knows; its clusters are shared, not copied."""
        known = self._clustered()
        return replace(known, carried=CarriedVisits.of(self._visits(), known.coarse))

    def state(self) -> ModelState:
        """Return the model as arrays and a header, to be kept between two logs."""
        return pack(self.parts())

    def _clustered(self) -> AppearanceParts:
        """Return what is known, with the coarse clusters of the exemplars as they are now."""
        n_rebuilds = self.two_scale.n_rebuilds
        if self._known.n_rebuilds != n_rebuilds:
            coarse = cluster_coarsely(self.two_scale)
            self._known = replace(self._known, coarse=coarse, n_rebuilds=n_rebuilds)
        return self._known

    def _visits(self) -> Visits:
        """Count the visits of each coarse cluster over all logs."""
        known = self._clustered()
        before = known.carried_now().visits(known.coarse)
        return before + self._spool.count(known.coarse_of, known.coarse.n_clusters)
