"""The settings that one evaluation scores: as asked, as learnt, one by one for a sweep."""

from dataclasses import replace

from mpap_cli.commands.settings import SettingsRequest, settings_from
from mpap_cli.errors import SettingError
from mpap_cli.evaluation.scoring import Variant
from mpap_cli.evaluation.sweep import parse_sweep, sweep_variants
from mpap_cli.params import PAPER_FEATURES, Settings
from mpap_cli.systems.collision import CollisionModel

METHOD = "mpap"
AS_LEARNT = "mpap as learnt"


def make_variants(
    request: SettingsRequest,
    sweep: str | None,
    learnt: Settings | None,
    model: CollisionModel | None,
) -> list[Variant]:
    """Return what is scored, the first as asked.

    Parameters
    ----------
    request : SettingsRequest
        Settings, with feature ``all`` and lists of bins.
    sweep : str or None
        KEY=V1,V2,...
    learnt : Settings or None
        What ``learn`` wrote; None where nothing was learnt.
    model : CollisionModel or None
        A model that is scored as it is.

    Returns
    -------
    list of Variant
        As asked; then as learnt, if that is other; then the sweep. What was asked is laid
        over what was learnt, unless it selects a profile.

    Examples
    --------
    >>> asked = SettingsRequest(feature="all", bins="6,12")
    >>> len(make_variants(asked, None, None, None))
    10
    """
    if model is not None:
        return [Variant(METHOD, model.settings)]
    variants = [Variant(METHOD, settings_from(one, learnt)) for one in _unfold(request)]
    if learnt is not None and learnt not in [variant.settings for variant in variants]:
        variants.append(Variant(AS_LEARNT, learnt))
    if sweep is not None:
        variants.extend(sweep_variants(variants[0].settings, parse_sweep(sweep)))
    return variants


def _unfold(request: SettingsRequest) -> list[SettingsRequest]:
    """Make one request of each feature and number of bins."""
    features: list[str | None] = [request.feature]
    if request.feature == "all":
        features = list(PAPER_FEATURES)
    bins: list[str | None] = [None]
    if request.bins is not None:
        bins = list(dict.fromkeys(part.strip() for part in request.bins.split(",")))
        if not all(bins):
            msg = f"--bins {request.bins}: expected a number or numbers such as 6,12"
            raise SettingError(msg)
    return [replace(request, feature=one, bins=n) for one in features for n in bins]
