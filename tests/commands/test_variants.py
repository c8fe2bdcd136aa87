"""Which settings one evaluation scores."""

from mpap_cli.commands.evaluating.variants import make_variants
from mpap_cli.commands.settings import SettingsRequest
from mpap_cli.params import make_settings


def test_without_a_request_what_was_learnt_is_scored() -> None:
    """Learnt settings are the one variant."""
    learnt = make_settings("robust", {"theta": "0.2"})

    (variant,) = make_variants(SettingsRequest(), None, learnt, None)

    assert variant.settings == learnt
    assert variant.method == "mpap"


def test_what_was_learnt_stands_beside_another_profile() -> None:
    """The second row is mpap as learnt, and only where something was learnt."""
    asked = SettingsRequest(feature="global-diff", bins="6")

    beside = make_variants(asked, None, make_settings(), None)
    alone = make_variants(asked, None, None, None)

    assert [variant.method for variant in beside] == ["mpap", "mpap as learnt"]
    assert [variant.method for variant in alone] == ["mpap"]


def test_a_seed_does_not_undo_what_was_learnt() -> None:
    """A single setting is laid over the learnt ones."""
    learnt = make_settings("paper", {"theta": "0.3"})

    first, second = make_variants(SettingsRequest(flags={"seed": "3"}), None, learnt, None)

    assert (first.settings.profile, first.settings.meta_point.theta) == ("paper", 0.3)
    assert first.settings.affinity.seed == 3
    assert second.settings == learnt
