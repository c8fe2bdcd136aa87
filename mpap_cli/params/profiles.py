"""All settings together: profiles, and texts by key to checked records and back."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, get_args, get_type_hints

from mpap_cli.errors import SettingError
from mpap_cli.params.appearance import ObstacleParams, StrapParams
from mpap_cli.params.checks import key_of, require
from mpap_cli.params.clustering import AffinityParams, MetaPointParams
from mpap_cli.params.image import ImageParams
from mpap_cli.params.labels import BumperParams, EvaluationParams, PropertyParams
from mpap_cli.params.scan import ScanParams


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Everything that can change a result, beside the input itself."""

    profile: str = "robust"
    scan: ScanParams = field(default_factory=ScanParams)
    bumper: BumperParams = field(default_factory=BumperParams)
    affinity: AffinityParams = field(default_factory=AffinityParams)
    meta_point: MetaPointParams = field(default_factory=MetaPointParams)
    properties: PropertyParams = field(default_factory=PropertyParams)
    evaluation: EvaluationParams = field(default_factory=EvaluationParams)
    image: ImageParams = field(default_factory=ImageParams)
    strap: StrapParams = field(default_factory=StrapParams)
    obstacle: ObstacleParams = field(default_factory=ObstacleParams)

    def __post_init__(self) -> None:
        """Refuse mixtures of the profiles: each has features of its own."""
        own = self.scan.feature == "inverse-min"
        wanted = "inverse-min" if self.profile == "robust" else "a feature of the paper"
        fits = own == (self.profile == "robust")
        require(fits, "feature", self.scan.feature, f"{wanted} under profile {self.profile}")


GROUPS: dict[str, type] = {
    "scan": ScanParams,
    "bumper": BumperParams,
    "affinity": AffinityParams,
    "meta_point": MetaPointParams,
    "properties": PropertyParams,
    "evaluation": EvaluationParams,
    "image": ImageParams,
    "strap": StrapParams,
    "obstacle": ObstacleParams,
}

PROFILES: dict[str, dict[str, str]] = {
    "robust": {"keep-scale": "true", "lookback-s": "1.0"},
    "paper": {
        "feature": "global-diff",
        "bins": "6",
        "theta": "0.10",
        "min-points": "5",
        "preference": "median",
        "learn-target": "contact",
        "readout": "exemplar",
        "obstacle-labels": "plain",
        "eps": "0.21",
        "reservoir": "2000",
        "known-share": "0",
        "neighbors": "1",
    },
}


def setting_fields() -> dict[str, tuple[str, Any]]:
    """Map every key to the name of its group and its dataclass field."""
    return {
        key_of(item.name): (group, item) for group, kind in GROUPS.items() for item in fields(kind)
    }


def make_settings(profile: str = "robust", values: Mapping[str, str] | None = None) -> Settings:
    """Build settings from a profile and the values given on top of it.

    Parameters
    ----------
    profile : str
        ``robust`` or ``paper``.
    values : mapping of str to str, optional
        Texts by key, as after ``--set``; ``none`` empties a setting that may be empty.

    Returns
    -------
    Settings
        Checked settings.

    Raises
    ------
    SettingError
        If a key does not exist or a value does not fit.

    Examples
    --------
    >>> make_settings("paper", {"theta": "0.2"}).meta_point.theta
    0.2
    """
    if profile not in PROFILES:
        msg = f"--profile: found {profile}, expected one of {', '.join(PROFILES)}"
        raise SettingError(msg)
    known = setting_fields()
    groups: dict[str, dict[str, Any]] = {group: {} for group in GROUPS}
    for key, text in {**PROFILES[profile], **(values or {})}.items():
        if key not in known:
            msg = f"setting {key}: no such setting; 'mpap config' lists them all"
            raise SettingError(msg)
        group, item = known[key]
        groups[group][item.name] = _parse(key, text, get_type_hints(GROUPS[group])[item.name])
    made = {group: kind(**groups[group]) for group, kind in GROUPS.items()}
    return Settings(profile=profile, **made)


def _parse(key: str, text: str, kind: Any) -> Any:
    """Turn the text of a setting into its type."""
    optional = type(None) in get_args(kind)
    if optional and text == "none":
        return None
    target = get_args(kind)[0] if optional else kind
    if target is bool:
        require(text in {"true", "false"}, key, text, "true or false")
        return text == "true"
    try:
        return target(text)
    except ValueError:
        msg = f"setting {key}: found {text}, expected {target.__name__}"
        raise SettingError(msg) from None


def settings_values(settings: Settings) -> dict[str, str]:
    """Return every setting as text by key, the inverse of :func:`make_settings`."""
    texts = {}
    for key, (group, item) in setting_fields().items():
        value = getattr(getattr(settings, group), item.name)
        texts[key] = _text(value)
    return texts


def _text(value: object) -> str:
    if value is None:
        return "none"
    return str(value).lower() if isinstance(value, bool) else str(value)
