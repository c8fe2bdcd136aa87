"""The table for a paper: LaTeX prints it as it stands."""

from dataclasses import fields
from typing import Any

import pytest

from mpap_cli.evaluation.rows import AucRow
from mpap_cli.outputs.latex import escaped, latex_table


def row(**values: Any) -> AucRow:
    """Return a row of auc.csv with nothing else in it."""
    return AucRow(**({item.name: None for item in fields(AucRow)} | values))


ROWS = [
    row(
        method="mpap",
        feature="inverse_min",
        bins=12,
        target="contact",
        protocol="leave-one-log-out",
        truth="bumper",
        logs=2,
        presses=5,
        positives=10,
        negatives=90,
        auc=0.8341,
        auc_low=0.7,
        auc_high=0.9,
        average_precision=0.5,
        brier_skill=-0.123,
    ),
    row(method="nearest-range"),
]


def test_rows_and_what_they_are() -> None:
    """Two digits, an interval where there is one, a dash for what is not known."""
    text = latex_table(ROWS)

    assert "% target contact, leave-one-log-out, truth bumper: 2 logs, 5 presses" in text
    assert r"mpap, inverse\_min, 12 bins & 0.83 [0.70, 0.90] & 0.50 & -0.12 \\" in text
    assert r"nearest-range & -- & -- & -- \\" in text


@pytest.mark.parametrize("sign", list("\\~^&%$#_{}"))
def test_no_sign_is_read_as_a_command(sign: str) -> None:
    """Each special sign is written in a form that prints it."""
    assert escaped(sign) != sign
    assert escaped(sign).startswith("\\")
