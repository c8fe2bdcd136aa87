r"""The main result as a table for a paper: rows for ``booktabs``, ready for ``\input``."""

from collections.abc import Sequence

from mpap_cli.evaluation.rows import AucRow

_SPECIAL = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    **{sign: f"\\{sign}" for sign in "&%$#_{}"},
}
_HEAD = r"method & AUC [95\,\%] & average precision & Brier skill \\"


def escaped(text: str) -> str:
    r"""Return a text that LaTeX prints as it stands.

    >>> escaped("50 % of a_b")
    '50 \\% of a\\_b'
    """
    return "".join(_SPECIAL.get(sign, sign) for sign in text)


def latex_table(rows: Sequence[AucRow]) -> str:
    r"""Lay out the rows of auc.csv as a tabular.

    Parameters
    ----------
    rows : sequence of AucRow
        In the order of the file.

    Returns
    -------
    str
        Comments that say what was scored and how, then a ``tabular`` with the lines of
        ``booktabs``. A figure that is not known is a dash.
    """
    first = rows[0]
    said = (
        f"target {first.target}, {first.protocol}, truth {first.truth}: {first.logs} logs, "
        f"{first.presses} presses, {first.positives} scans in contact of "
        f"{first.positives + first.negatives}"
    )
    lines = [f"% {said}", r"\begin{tabular}{lccc}", r"\toprule", _HEAD, r"\midrule"]
    lines += [_line(row) for row in rows]
    lines += [r"\bottomrule", r"\end{tabular}"]
    return "".join(f"{line}\n" for line in lines)


def _line(row: AucRow) -> str:
    """Return one method."""
    parts = (row.method, row.feature, None if row.bins is None else f"{row.bins} bins")
    name = ", ".join(escaped(part) for part in parts if part)
    cells = [name, _with_interval(row), _figure(row.average_precision), _figure(row.brier_skill)]
    return " & ".join(cells) + r" \\"


def _with_interval(row: AucRow) -> str:
    interval = "" if row.auc_low is None else f" [{row.auc_low:.2f}, {row.auc_high:.2f}]"
    return _figure(row.auc) + interval


def _figure(value: float | None) -> str:
    return "--" if value is None else f"{value:.2f}"
