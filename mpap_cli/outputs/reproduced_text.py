"""What ``reproduce`` shows: the tables of the paper with our numbers beside its own."""

from collections.abc import Iterable, Sequence

from mpap_cli.evaluation.paper_tables import ODDITIES, TABLE_1
from mpap_cli.evaluation.reproduced import ITEMS, Finding, Item, Picture, ReproducedRow
from mpap_cli.outputs.text_table import aligned

_NOTHING = "-"
_WHOLE = 1e-9
_BRIEF_S = 0.1
_LARGE, _MIDDLE = 1000.0, 10.0
_HEAD = (
    "Written by `mpap reproduce`. Beside our numbers stand those of Ott & Ramos (2013), on other "
    "data: compare the shape, not the digits. A number with ± is the mean and the standard "
    "deviation of repeats. Durations are CPU seconds of one thread."
)
Cells = list[str]


def figure_text(value: float, like: float | None = None) -> str:
    """Write a number with as many digits as it needs beside others of its size.

    Parameters
    ----------
    value : float
        The number.
    like : float, optional
        Take as many digits as this one needs (a spread beside its mean).

    Examples
    --------
    >>> figure_text(31464.0), figure_text(121.4), figure_text(10.0), figure_text(0.8766)
    ('31,464', '121.4', '10', '0.88')
    """
    model = abs(value if like is None else like)
    if model >= _LARGE:
        return f"{value:,.0f}"
    if like is None and abs(value - round(value)) < _WHOLE:
        return f"{value:.0f}"
    return f"{value:.1f}" if model >= _MIDDLE else f"{value:.2f}"


def _ours(row: ReproducedRow) -> str:
    """Write what we found, with its spread."""
    if row.seconds is not None:
        return f"{row.seconds:.3f}" if row.seconds < _BRIEF_S else figure_text(row.seconds)
    if row.ours is None:
        return _NOTHING
    if not row.sd:
        return figure_text(row.ours)
    # a mean that happens to be whole has the digits of its spread
    digits = row.ours if abs(row.ours) >= _MIDDLE else 0.5
    return f"{figure_text(row.ours, digits)} ± {figure_text(row.sd, digits)}"


def pivot(rows: Sequence[ReproducedRow]) -> list[Cells]:
    """Lay out the rows of one table: a line for each row, a column for each quantity.

    Beside a quantity of which the paper prints a number stands a column of its own for it.

    Returns
    -------
    list of list of str
        The header first.
    """
    quantities = list(dict.fromkeys(row.quantity for row in rows))
    printed = {row.quantity for row in rows if row.paper is not None}
    cells = {(row.row, row.quantity): row for row in rows}
    header = [""]
    for quantity in quantities:
        header += [quantity, "paper"] if quantity in printed else [quantity]
    lines = [header]
    for name in dict.fromkeys(row.row for row in rows):
        line = [name]
        for quantity in quantities:
            row = cells.get((name, quantity))
            line.append(_NOTHING if row is None else _ours(row))
            if quantity in printed:
                paper = None if row is None else row.paper
                line.append(_NOTHING if paper is None else figure_text(paper))
        lines.append(line)
    return lines


def markdown(
    rows: Sequence[ReproducedRow], pictures: Sequence[Picture], findings: Sequence[Finding]
) -> str:
    """Return the report: item by item its tables, findings, oddities and pictures.

    Parameters
    ----------
    rows : sequence of ReproducedRow
        All numbers.
    pictures : sequence of Picture
        Figures in the same folder.
    findings : sequence of Finding
        Sentences about items.

    Returns
    -------
    str
        Markdown; nothing of items that were not made.
    """
    lines = [
        "# The experiments of the paper, made again",
        "",
        _HEAD,
    ]
    made = {row.item.partition(", ")[0] for row in rows}
    made |= {ITEMS[one.item].title for one in pictures}
    made |= {ITEMS[one.item].title for one in findings}
    for key, item in ITEMS.items():
        if item.title in made:
            lines += _section(key, item, rows, pictures, findings)
    return "\n".join(lines) + "\n"


def _section(
    key: str,
    item: Item,
    rows: Sequence[ReproducedRow],
    pictures: Sequence[Picture],
    findings: Sequence[Finding],
) -> Cells:
    """Return everything about one item."""
    lines = ["", f"## {item.title} (section {item.section})"]
    if key == "table-1":
        header = ["experiment", "clustering sensor", "self-supervision sensor"]
        lines += ["", *_markdown_table([header, *map(list, TABLE_1)], right=False)]
    mine = [row for row in rows if row.item.partition(", ")[0] == item.title]
    for name in dict.fromkeys(row.item for row in mine):
        table = [row for row in mine if row.item == name]
        part = name.partition(", ")[2]
        lines += ["", f"### {part[0].upper()}{part[1:]}"] if part else []
        lines += ["", *_markdown_table(pivot(table)), *_notes(table)]
    lines += _paragraphs(one.words for one in findings if one.item == key)
    lines += _paragraphs(f"Odd in the paper: {one.words}" for one in ODDITIES if one.item == key)
    for one in pictures:
        if one.item == key:
            lines += ["", f"![{one.caption}]({one.file})", "", f"*{one.caption}*"]
    return lines


def _notes(table: Sequence[ReproducedRow]) -> Cells:
    """Return each note of a table once."""
    return _paragraphs(dict.fromkeys(row.note for row in table if row.note))


def _paragraphs(texts: Iterable[str]) -> Cells:
    return [line for text in texts for line in ("", text)]


def _markdown_table(lines: Sequence[Cells], *, right: bool = True) -> Cells:
    """Return a table; what stands behind the first column is flush right if wanted."""
    header, *body = [[cell.replace("|", r"\|") for cell in line] for line in lines]
    rule = ["---", *["---:" if right else "---"] * (len(header) - 1)]
    return [f"| {' | '.join(line)} |" for line in (header, rule, *body)]


def reproduced_text(rows: Sequence[ReproducedRow], findings: Sequence[Finding]) -> str:
    """Lay out the tables and findings for a terminal."""
    blocks = []
    for name in dict.fromkeys(row.item for row in rows):
        table = pivot([row for row in rows if row.item == name])
        right = range(1, len(table[0]))
        blocks.append([name, *aligned(table, right=right)])
    blocks += [[f"{ITEMS[one.item].title}: {one.words}"] for one in findings]
    return "\n".join("".join(f"{line}\n" for line in block) for block in blocks)
