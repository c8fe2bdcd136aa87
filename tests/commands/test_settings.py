"""Settings from profile, file and command line."""

from pathlib import Path

import pytest

from mpap_cli.commands.settings import SettingsRequest, config, profile_of, settings_from
from mpap_cli.errors import SettingError, UsageError
from mpap_cli.params import setting_fields


def test_the_command_line_wins_over_the_file_and_the_file_over_the_profile(tmp_path: Path) -> None:
    """Each value comes from the strongest place that names it."""
    file = tmp_path / "mine.toml"
    file.write_text('theta = 0.3\nmin-points = 7\npreference = "min"\n', encoding="utf-8")
    request = SettingsRequest(profile="paper", config=file, pairs=("theta=0.4",))

    settings = settings_from(request)

    assert settings.meta_point.theta == 0.4
    assert settings.meta_point.min_points == 7
    assert settings.affinity.preference == "min"
    assert settings.properties.readout == "exemplar"


def test_config_lists_every_setting_with_its_origin(tmp_path: Path) -> None:
    """Every key stands once, with the place its value came from."""
    file = tmp_path / "mine.toml"
    file.write_text("keep-scale = false\n", encoding="utf-8")
    request = SettingsRequest(config=file, pairs=("theta=0.4",), flags={"seed": "3"})

    rows = {row.key: row for row in config(request)}

    assert set(rows) == set(setting_fields())
    assert rows["theta"].origin == "command line"
    assert (rows["seed"].value, rows["seed"].origin) == ("3", "command line")
    assert (rows["keep-scale"].value, rows["keep-scale"].origin) == ("false", "mine.toml")
    assert rows["lookback-s"].origin == "profile robust"
    assert rows["damping"].origin == "default"


@pytest.mark.parametrize(
    ("request_", "profile"),
    [
        (SettingsRequest(), "robust"),
        (SettingsRequest(feature="min-value"), "paper"),
        (SettingsRequest(bins="12"), "paper"),
        (SettingsRequest(profile="paper"), "paper"),
    ],
)
def test_feature_or_bins_select_profile_paper(request_: SettingsRequest, profile: str) -> None:
    """The paper's features belong to the paper's profile."""
    assert profile_of(request_) == profile


def test_profile_robust_refuses_a_feature() -> None:
    """Two profiles, no mixtures."""
    with pytest.raises(UsageError, match="--profile robust has its own feature"):
        settings_from(SettingsRequest(profile="robust", feature="min-value"))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("theta 0.3", "--config bad.toml"),
        ("[clustering]\ntheta = 0.3", "clustering is a table or list"),
        ("theta = [0.1, 0.2]", "theta is a table or list"),
    ],
)
def test_a_bad_file_is_named(tmp_path: Path, text: str, expected: str) -> None:
    """A file that is no list of keys and values is refused by name."""
    file = tmp_path / "bad.toml"
    file.write_text(text, encoding="utf-8")

    with pytest.raises(SettingError, match=expected):
        settings_from(SettingsRequest(config=file))


def test_a_pair_without_value_is_refused() -> None:
    """--set wants KEY=VALUE."""
    with pytest.raises(SettingError, match="expected KEY=VALUE"):
        settings_from(SettingsRequest(pairs=("theta",)))


def test_profiles_are_not_mixed_by_a_setting() -> None:
    """A feature of one profile is refused under the other, however it is asked for."""
    for request in (
        SettingsRequest(pairs=("feature=max-value",)),
        SettingsRequest(profile="paper", pairs=("feature=inverse-min",)),
    ):
        with pytest.raises(SettingError, match="under profile"):
            settings_from(request)


def test_a_request_is_laid_over_what_was_learnt() -> None:
    """Without a profile asked for, learnt settings stay beneath those given."""
    learnt = settings_from(SettingsRequest(profile="paper", pairs=("theta=0.3",)))

    over = settings_from(SettingsRequest(pairs=("resamples=50",)), learnt)
    fresh = settings_from(SettingsRequest(feature="min-value"), learnt)

    assert (over.profile, over.meta_point.theta, over.evaluation.resamples) == ("paper", 0.3, 50)
    assert fresh.meta_point.theta == 0.1
