"""Names that come from logs become names of files on every system."""

from hypothesis import given
from hypothesis import strategies as st

from mpap_cli.outputs.file_names import file_name

RESERVED = {"con", "prn", "aux", "nul", *(f"{port}{i}" for port in ("com", "lpt") for i in "0123")}
NAMES = st.one_of(st.text(max_size=300), st.sampled_from(["NUL", "con.bag", "COM1.x", "...", ""]))


@given(NAMES, st.sampled_from(["", ".mcap", "-001.bag"]))
def test_every_name_is_one_for_every_system(name: str, ending: str) -> None:
    """No separator, wildcard, device, trailing dot or blank; short, and its ending stays."""
    made = file_name(name, ending)

    assert made
    assert not set(made) - set("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-")
    assert made.split(".")[0].lower() not in RESERVED
    assert not made.endswith((".", " "))
    assert len(made) <= 110
    assert made.endswith(ending)


def test_a_good_name_stays() -> None:
    """What every system takes is left alone."""
    assert file_name("0-day1.bag", ".mcap") == "0-day1.bag.mcap"


def test_a_number_in_front_keeps_names_apart() -> None:
    """Names that differ only in what is replaced are told apart by what stands before them."""
    made = {file_name(f"{index}-{name}") for index, name in enumerate(["a:b", "a?b", "a_b"])}

    assert len(made) == 3
