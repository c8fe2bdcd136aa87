"""Plain tables of aligned words."""

from collections.abc import Collection, Sequence


def printable(text: str) -> str:
    """Replace what would move the cursor or color the terminal: names come from files.

    >>> printable("scan" + chr(27) + "[31m")
    'scan?[31m'
    """
    return "".join(sign if sign.isprintable() else "?" for sign in text)


def aligned(lines: Sequence[Sequence[str]], right: Collection[int] = ()) -> list[str]:
    """Lay out cells in columns, two blanks apart.

    Parameters
    ----------
    lines : sequence of sequences of str
        Cells, as many in each line.
    right : collection of int
        Columns that are flush right; the others are flush left.

    Returns
    -------
    list of str
        One text a line, without blanks at its end.

    Examples
    --------
    >>> aligned([("log", "scans"), ("day1.bag", "7")], right={1})
    ['log       scans', 'day1.bag      7']
    """
    clean = [[printable(cell) for cell in line] for line in lines]
    widths = [max(map(len, column)) for column in zip(*clean, strict=True)]
    return [
        "  ".join(
            cell.rjust(width) if index in right else cell.ljust(width)
            for index, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in clean
    ]


def count(number: int, word: str) -> str:
    """Return a number with its noun.

    >>> count(1, "press"), count(9640, "scan")
    ('1 press', '9,640 scans')
    """
    plural = word + ("es" if word.endswith(("s", "ch")) else "s")
    return f"{number:,} {word if number == 1 else plural}"
