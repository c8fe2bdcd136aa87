"""Settings: one frozen dataclass a system; each default says where it comes from.

A setting's key is its field's name with hyphens (``min_points`` is ``min-points``);
``--set KEY=VALUE``, a TOML file and the profiles all go through :func:`make_settings`.
"""

from mpap_cli.params.appearance import ObstacleParams, StrapParams
from mpap_cli.params.clustering import AffinityParams, MetaPointParams, parse_preference
from mpap_cli.params.image import ImageParams
from mpap_cli.params.labels import (
    READOUTS,
    TARGETS,
    BumperParams,
    EvaluationParams,
    PropertyParams,
)
from mpap_cli.params.profiles import (
    PROFILES,
    Settings,
    make_settings,
    setting_fields,
    settings_values,
)
from mpap_cli.params.scan import PAPER_FEATURES, SCAN_FEATURE_NAMES, ScanParams

__all__ = [
    "PAPER_FEATURES",
    "PROFILES",
    "READOUTS",
    "SCAN_FEATURE_NAMES",
    "TARGETS",
    "AffinityParams",
    "BumperParams",
    "EvaluationParams",
    "ImageParams",
    "MetaPointParams",
    "ObstacleParams",
    "PropertyParams",
    "ScanParams",
    "Settings",
    "StrapParams",
    "make_settings",
    "parse_preference",
    "setting_fields",
    "settings_values",
]
