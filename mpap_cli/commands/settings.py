"""Settings from profile, file and command line; ``mpap config`` lists them."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from mpap_cli.errors import MpapError, SettingError, UsageError, require_finite
from mpap_cli.params import PROFILES, Settings, make_settings, setting_fields, settings_values

_LARGEST_CONFIG = 1 << 16


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingsRequest:
    """What was asked for: the command line wins over the file, the file over the profile.

    ``pairs`` are KEY=VALUE texts, ``flags`` values by key of options with a name of their own.
    """

    profile: str | None = None
    feature: str | None = None
    bins: str | None = None
    config: Path | None = None
    pairs: tuple[str, ...] = ()
    flags: Mapping[str, str] = field(default_factory=dict)

    @property
    def selects_profile(self) -> bool:
        """Whether a profile was asked for, so that learnt settings count no more."""
        return (self.profile or self.feature or self.bins) is not None

    @property
    def says_nothing(self) -> bool:
        """Whether nothing was asked for, so that learnt settings may be taken."""
        named = self.profile or self.feature or self.bins or self.config
        return not (named or self.pairs or self.flags)


@dataclass(frozen=True, slots=True)
class SettingRow:
    """One line of ``mpap config``."""

    key: Annotated[str, "name for `--set`"]
    value: Annotated[str, "its value"]
    origin: Annotated[str, "default, profile, file or command line"]
    section: Annotated[str, "section of the paper; `ours` is not in it"]
    meaning: Annotated[str, "what it does"]


def profile_of(request: SettingsRequest) -> str:
    """Return the profile that a request means.

    Raises
    ------
    UsageError
        If ``--profile robust`` stands beside ``--feature`` or ``--bins``.

    Examples
    --------
    >>> profile_of(SettingsRequest(feature="max-value"))
    'paper'
    """
    papers = request.feature is not None or request.bins is not None
    if papers and request.profile == "robust":
        msg = (
            "--profile robust has its own feature; --feature and --bins select profile paper: "
            "leave out one of them"
        )
        raise UsageError(msg)
    return request.profile or ("paper" if papers else "robust")


def settings_from(request: SettingsRequest, learnt: Settings | None = None) -> Settings:
    """Build checked settings; ``--feature all`` and several bins are the caller's to unfold.

    Parameters
    ----------
    request : SettingsRequest
        What was asked for.
    learnt : Settings, optional
        What the request is laid over, unless it selects a profile.

    Returns
    -------
    Settings
        Checked.

    Raises
    ------
    SettingError
        If a key or value does not exist, or the file is no TOML of keys and values.
    """
    values, _ = _collect(request)
    if learnt is not None and not request.selects_profile:
        return make_settings(learnt.profile, {**settings_values(learnt), **values})
    return make_settings(profile_of(request), values)


def config(request: SettingsRequest) -> list[SettingRow]:
    """List every setting with its value, origin and section of the paper."""
    profile = profile_of(request)
    values, origins = _collect(request)
    shown = settings_values(make_settings(profile, values))
    from_profile = dict.fromkeys(PROFILES[profile], f"profile {profile}")
    origins = {**from_profile, **origins}
    return [
        SettingRow(
            key=key,
            value=shown[key],
            origin=origins.get(key, "default"),
            section=item.metadata["section"],
            meaning=item.metadata["text"],
        )
        for key, (_, item) in setting_fields().items()
    ]


def _collect(request: SettingsRequest) -> tuple[dict[str, str], dict[str, str]]:
    """Return values by key, and where each came from."""
    values: dict[str, str] = {}
    origins: dict[str, str] = {}
    if request.config is not None:
        for key, value in _read_toml(request.config).items():
            values[key], origins[key] = value, request.config.name
    for pair in request.pairs:
        key, equals, value = pair.partition("=")
        if not equals:
            msg = f"--set {pair}: expected KEY=VALUE; 'mpap config' lists the keys"
            raise SettingError(msg)
        values[key.strip()], origins[key.strip()] = value.strip(), "command line"
    named = {"feature": request.feature, "bins": request.bins, **request.flags}
    for key, named_value in named.items():
        if named_value is not None:
            values[key], origins[key] = named_value, "command line"
    return values, origins


def _read_toml(path: Path) -> dict[str, str]:
    """Read a flat TOML file of settings as texts."""
    try:
        require_finite(path)
        with path.open("rb") as file:
            content = file.read(_LARGEST_CONFIG + 1)
        loaded = tomllib.loads(content[:_LARGEST_CONFIG].decode())
        texts = {key: _text(value) for key, value in loaded.items()}
    except OSError as error:
        msg = f"--config {path}: {(error.strerror or str(error)).lower()}"
        raise MpapError(msg) from error
    except (ValueError, RecursionError) as error:
        msg = f"--config {path.name}: {error}"
        raise SettingError(msg) from error
    if len(content) > _LARGEST_CONFIG:
        msg = f"--config {path.name}: larger than {_LARGEST_CONFIG:,} bytes; give KEY = VALUE lines"
        raise SettingError(msg)
    for key, text in texts.items():
        if text is None:
            msg = f"--config {path.name}: {key} is a table or list; write one KEY = VALUE per line"
            raise SettingError(msg)
    return {key: text for key, text in texts.items() if text is not None}


def _text(value: object) -> str | None:
    """Return a value of a TOML file as ``--set`` would have it; None for tables and lists."""
    if isinstance(value, dict | list):
        return None
    return str(value).lower() if isinstance(value, bool) else str(value)
