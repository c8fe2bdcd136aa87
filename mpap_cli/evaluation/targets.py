"""What is scored: pressed now, a press that begins, or a press that is about to begin."""

import math
from dataclasses import dataclass, replace

from mpap_cli.errors import UsageError
from mpap_cli.params import TARGETS, Settings

LONGEST_S = 86_400.0


@dataclass(frozen=True, slots=True)
class Target:
    """A target by name; ``early_s`` is the warning time in seconds (None: the settings')."""

    name: str
    early_s: float | None = None

    @property
    def pair(self) -> int:
        """Column of the target among the labels contact, onset, early."""
        return TARGETS.index(self.name)

    def applied_to(self, settings: Settings) -> Settings:
        """Return the settings with the warning time of this target."""
        if self.early_s is None:
            return settings
        return replace(settings, properties=replace(settings.properties, early_s=self.early_s))

    def text(self, settings: Settings) -> str:
        """Return the target as tables name it.

        >>> Target("early").text(Settings())
        'early:1'
        """
        if self.name != "early":
            return self.name
        return f"early:{self.applied_to(settings).properties.early_s:g}"


def parse_target(text: str) -> Target:
    """Read ``contact``, ``onset``, ``early`` or ``early:SECONDS``.

    Raises
    ------
    UsageError
        If the text is none of these.

    Examples
    --------
    >>> parse_target("early:2.5")
    Target(name='early', early_s=2.5)
    """
    name, colon, number = text.partition(":")
    if text in TARGETS:
        return Target(text)
    try:
        early_s = float(number)
    except ValueError:
        early_s = math.nan
    if name != "early" or not colon or not 0 < early_s <= LONGEST_S:
        msg = f"--target: found {text}, expected contact, onset or early:SECONDS"
        raise UsageError(msg)
    return Target(name, early_s)
