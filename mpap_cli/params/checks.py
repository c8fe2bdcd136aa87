"""A setting as a dataclass field with its section, meaning and choices, and its check."""

from dataclasses import field, fields
from typing import Any

from mpap_cli.errors import SettingError

MOST_SECONDS = 1e9
MOST_COUNT = 10**9


def setting(default: Any, section: str, text: str, choices: tuple[str, ...] = ()) -> Any:
    """Make a dataclass field that carries its section in the paper, meaning and choices."""
    metadata = {"section": section, "text": text, "choices": choices}
    return field(default=default, metadata=metadata)


def key_of(name: str) -> str:
    """Return the setting's key for a field name.

    >>> key_of("min_points")
    'min-points'
    """
    return name.replace("_", "-")


def require(holds: bool, key: str, found: object, wanted: str) -> None:
    """Raise a SettingError that names key, finding and wish unless it holds."""
    if not holds:
        msg = f"setting {key}: found {found}, expected {wanted}"
        raise SettingError(msg)


def require_seconds(key: str, seconds: float, *, zero: bool = False) -> None:
    """Require a time span that nanoseconds can hold: above 0 (or 0), at most some 30 years."""
    wanted = "0 or more" if zero else "more than 0"
    require(
        0 <= seconds <= MOST_SECONDS and (zero or seconds > 0),
        key,
        seconds,
        f"{wanted}, at most {MOST_SECONDS:g}",
    )


def check_choices(params: Any) -> None:
    """Check every field that has choices."""
    for item in fields(params):
        choices = item.metadata["choices"]
        found = getattr(params, item.name)
        if choices:
            require(found in choices, key_of(item.name), found, "one of " + ", ".join(choices))
