"""Tables with the paper's numbers beside ours."""

from dataclasses import replace

from mpap_cli.evaluation.reproduced import Finding, Picture, ReproducedRow
from mpap_cli.outputs.reproduced_text import markdown, pivot, reproduced_text

ROW = ReproducedRow(
    experiment="textures",
    item="Table 2",
    row="STRAP",
    quantity="V-measure",
    paper=0.79,
    ours=0.8123,
    sd=0.0261,
    n=10,
    seconds=None,
    note="",
)


def test_the_papers_number_stands_beside_ours() -> None:
    """A quantity that the paper prints has a column of its own for it, others have none."""
    clusters = replace(ROW, quantity="clusters", paper=None, ours=7.0, sd=0.0)

    lines = pivot([ROW, clusters])

    assert lines == [
        ["", "V-measure", "paper", "clusters"],
        ["STRAP", "0.81 ± 0.03", "0.79", "7"],
    ]


def test_missing_numbers_are_dashes() -> None:
    """A row without a number of a quantity, of ours or the paper's, has a dash there."""
    other = replace(ROW, row="k-means", quantity="ARI", paper=None, ours=None)

    lines = pivot([ROW, other])

    assert lines[1] == ["STRAP", "0.81 ± 0.03", "0.79", "-"]
    assert lines[2] == ["k-means", "-", "-", "-"]


def test_durations_are_shown_from_their_own_column() -> None:
    """A row with seconds shows them as ours."""
    took = replace(ROW, quantity="duration (s)", paper=60.61, ours=None, sd=None, seconds=1.234)

    assert pivot([took])[1] == ["STRAP", "1.23", "60.6"]


def test_large_numbers_have_no_fraction() -> None:
    """Thousands are set apart, their spread has no more digits than they have."""
    points = replace(ROW, quantity="raw points", paper=31_464.0, ours=31_464.5, sd=12.3)

    assert pivot([points])[1] == ["STRAP", "31,464 ± 12", "31,464"]


def test_the_report_has_a_section_for_each_item() -> None:
    """Tables, notes once, findings, oddities and pictures of an item stand together."""
    second = replace(ROW, item="Table 2, held out", paper=None, note="A note.")
    third = replace(second, quantity="ARI")
    finding = Finding("table-2", "STRAP is worse.")
    picture = Picture("figure-8", "figure-08.png", "Ten Gaussians.")

    text = markdown([ROW, second, third], [picture], [finding])

    assert "## Table 2 (section 5.1.1)\n\n|  | V-measure | paper |\n| --- | ---: | ---: |\n" in text
    assert "### Held out\n" in text
    assert text.count("A note.") == 1
    assert text.index("STRAP is worse.") < text.index("## Figure 8")
    assert "![Ten Gaussians.](figure-08.png)" in text
    assert "Table 4" not in text


def test_table_1_is_printed_with_its_oddity() -> None:
    """It holds no numbers; that its sections are swapped is said."""
    text = markdown([], [], [Finding("table-1", "Here: simulated.")])

    assert "| Section 5.1.1 | Synthetic | None |" in text
    assert "other way round" in text


def test_bars_in_names_do_not_break_a_table() -> None:
    """A row may hold what parts cells in Markdown."""
    assert "a\\|b" in markdown([replace(ROW, row="a|b")], [], [])


def test_the_terminal_gets_the_same_tables() -> None:
    """Plain aligned text, then the findings."""
    text = reproduced_text([ROW], [Finding("table-2", "STRAP is worse.")])

    assert text.splitlines() == [
        "Table 2",
        "         V-measure  paper",
        "STRAP  0.81 ± 0.03   0.79",
        "",
        "Table 2: STRAP is worse.",
    ]
