"""Targets as they are typed."""

import pytest

from mpap_cli.errors import UsageError
from mpap_cli.evaluation.targets import Target, parse_target
from mpap_cli.params import Settings


@pytest.mark.parametrize(
    ("text", "target", "shown"),
    [
        ("contact", Target("contact"), "contact"),
        ("onset", Target("onset"), "onset"),
        ("early", Target("early"), "early:1"),
        ("early:2.5", Target("early", 2.5), "early:2.5"),
        ("early:2.0", Target("early", 2.0), "early:2"),
    ],
)
def test_target_is_read_and_shown(text: str, target: Target, shown: str) -> None:
    """The warning time is the setting's unless the target names one."""
    found = parse_target(text)

    assert found == target
    assert found.text(Settings()) == shown


@pytest.mark.parametrize(
    "text", ["", "late", "early:", "early:0", "early:-1", "early:nan", "early:inf", "onset:1"]
)
def test_other_words_are_refused(text: str) -> None:
    """The message lists what there is."""
    with pytest.raises(UsageError, match=f"--target: found {text}, expected contact"):
        parse_target(text)


def test_warning_time_enters_the_settings() -> None:
    """A target with a time of its own changes the label rule, nothing else."""
    settings = Settings()

    changed = parse_target("early:3").applied_to(settings)

    assert changed.properties.early_s == 3
    assert settings.properties.early_s == 1
    assert changed.scan == settings.scan
