"""Groups of logs by folder, expression or file."""

from pathlib import Path

import pytest

from mpap_cli.errors import MpapError, UsageError
from mpap_cli.evaluation import groups
from mpap_cli.evaluation.groups import group_names
from mpap_cli.observations import ObservedLog


def log_at(path: str) -> ObservedLog:
    """Make a log that lies somewhere."""
    name = Path(path).name
    return ObservedLog(name, path, 0, 1, 0.0, None, (), "bumper", lambda: iter(()))


LOGS = [log_at("day1/neato-2018-a1.bag"), log_at("day2/neato-2018-b1.bag")]


def test_folder_and_bracket_name_the_groups() -> None:
    """The parent folder, or what the first bracket matches."""
    assert group_names(LOGS, "folder") == ("day1", "day2")
    assert group_names(LOGS, r"neato-\d+-([a-z])") == ("a", "b")


def test_file_lists_groups_by_base_name(tmp_path: Path) -> None:
    """Columns log and group; other columns do not matter."""
    table = tmp_path / "groups.csv"
    table.write_text("note,log,group\nx,neato-2018-a1.bag,red\n,neato-2018-b1.bag,blue\n")

    names = group_names(LOGS, str(table))

    assert names == ("red", "blue")


@pytest.mark.parametrize(
    ("groups", "match"),
    [
        ("neato", "found no bracket"),
        ("(", "no regular expression"),
        ("(a{99999999999})", "no regular expression"),
        ("(" * 5000 + ")" * 5000, "no regular expression"),
        ("(gazebo)", "matches nothing in day1"),
        ("(x)?neato", "matches nothing in day1"),
    ],
)
def test_groups_that_say_nothing_are_refused(groups: str, match: str) -> None:
    """The message names the option, what was found and what to do."""
    with pytest.raises(UsageError, match=match):
        group_names(LOGS, groups)


def test_an_expression_that_never_ends_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """A repeat of a repeat tries more ways than there is time."""
    monkeypatch.setattr(groups, "MOST_SECONDS", 0.5)

    with pytest.raises(UsageError, match=r"found no match within 0.5 s; take out what repeats"):
        group_names([log_at("day/" + "a" * 60)], "((?:a+)+)!")


def test_paths_that_are_no_text_are_matched() -> None:
    """Names of files may be any bytes."""
    assert group_names([log_at("day/\udcff\n\x1b1.bag")], "(day/.)") == ("day/\udcff",)


def test_a_file_that_is_not_there_is_no_usage_error() -> None:
    """A missing file ends with exit code 1, as everywhere."""
    with pytest.raises(MpapError, match=r"missing\.csv: no such file") as caught:
        group_names(LOGS, "missing.csv")

    assert caught.value.exit_code == 1


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("log,robot\n", "need log and group"),
        ("log,group\nneato-2018-a1.bag,red\n", "no group for neato-2018-b1.bag"),
        ("", "need log and group"),
    ],
)
def test_file_without_a_group_is_refused(tmp_path: Path, text: str, match: str) -> None:
    """Every log needs a group."""
    table = tmp_path / "groups.csv"
    table.write_text(text)

    with pytest.raises(UsageError, match=match):
        group_names(LOGS, str(table))
