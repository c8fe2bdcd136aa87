"""One setting at several values: how much a result hangs on it (``--sweep``)."""

from dataclasses import dataclass

from mpap_cli.errors import UsageError
from mpap_cli.evaluation.scoring import Variant
from mpap_cli.params import Settings, make_settings, settings_values

MOST_VALUES = 100
_MOST_SHOWN = 200


@dataclass(frozen=True, slots=True)
class Sweep:
    """A setting's key and the values it takes, as texts."""

    key: str
    values: tuple[str, ...]


def parse_sweep(text: str) -> Sweep:
    """Read ``KEY=V1,V2,...``.

    Raises
    ------
    UsageError
        If there is no key or no value, or more than 100 of them.

    Examples
    --------
    >>> parse_sweep("theta=0.05,0.1")
    Sweep(key='theta', values=('0.05', '0.1'))
    """
    key, _, listed = text.partition("=")
    values = tuple(value.strip() for value in listed.split(","))
    if not key.strip() or not all(values):
        shown = text[:_MOST_SHOWN]
        msg = f"--sweep: found {shown}, expected KEY=V1,V2,...; 'mpap config' lists the keys"
        raise UsageError(msg)
    if len(values) > MOST_VALUES:
        msg = f"--sweep: found {len(values):,} values, expected {MOST_VALUES} at most"
        raise UsageError(msg)
    return Sweep(key.strip(), values)


def sweep_variants(settings: Settings, asked: Sweep) -> list[Variant]:
    """Return the settings with each value of the key, named ``mpap KEY=VALUE``.

    Raises
    ------
    SettingError
        If the key does not exist or a value does not fit.
    """
    values = settings_values(settings)
    return [
        Variant(
            f"mpap {asked.key}={value}",
            make_settings(settings.profile, {**values, asked.key: value}),
        )
        for value in asked.values
    ]
