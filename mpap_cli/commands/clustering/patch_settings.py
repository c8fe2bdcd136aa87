"""Settings with which labelled patches are clustered (section 5.1.1)."""

from collections.abc import Mapping
from dataclasses import asdict, replace
from types import MappingProxyType

from mpap_cli.commands.settings import SettingsRequest, config, settings_from
from mpap_cli.evaluation.clusterers.records import PATCH_SETTINGS, ClustererSettings
from mpap_cli.params import MetaPointParams, Settings, make_settings

PAPER_THETA = 0.2

BASES: Mapping[str, ClustererSettings] = MappingProxyType(
    {
        "robust": PATCH_SETTINGS,
        "paper": ClustererSettings(meta_point=MetaPointParams(theta=PAPER_THETA, min_points=5)),
    }
)
"""What each profile means for patches; section 5.1 prints theta 0.2 and 5 points for images."""


def patch_settings(request: SettingsRequest) -> Settings:
    """Lay what was asked for over the profile's settings of patches.

    Parameters
    ----------
    request : SettingsRequest
        Profile (default: robust) and settings.

    Returns
    -------
    Settings
        Those of meta-points, affinity propagation and STRAP are of :data:`BASES`.

    Raises
    ------
    SettingError
        If a key or value does not exist.

    Examples
    --------
    >>> patch_settings(SettingsRequest(profile="paper")).meta_point.theta
    0.2
    """
    profile = request.profile or "robust"
    base = BASES[profile]
    values = {
        key.replace("_", "-"): _text(value)
        for part in (base.meta_point, base.affinity, base.strap)
        for key, value in asdict(part).items()
    }
    return settings_from(replace(request, profile=None), make_settings(profile, values))


def clusterer_settings(settings: Settings, request: SettingsRequest) -> ClustererSettings:
    """Return what the clusterers need of the settings.

    Theta comes from the patches where the profile has it so, unless it was asked for.
    """
    theta = next(row for row in config(replace(request, profile=None)) if row.key == "theta")
    automatic = BASES[settings.profile].theta_from_points
    return ClustererSettings(
        meta_point=settings.meta_point,
        affinity=settings.affinity,
        strap=settings.strap,
        theta_from_points=automatic and theta.origin == "default",
    )


def _text(value: object) -> str:
    """Write a value as after ``--set``."""
    if value is None:
        return "none"
    return str(value).lower() if isinstance(value, bool) else str(value)
