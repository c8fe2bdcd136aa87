"""Many runs in few words: only what is so is said."""

import math
from dataclasses import replace

import pytest

from mpap_cli.evaluation.clusterers.scores import ClusteringRow
from mpap_cli.evaluation.clusterers.summary import findings, summarize


def row(method: str, variant: str, v: float, seconds: float = 1.0, seed: int = 0) -> ClusteringRow:
    """Return a run with this V-measure."""
    own = method == "mpap"
    return ClusteringRow(
        method=method,
        variant=variant,
        order_seed=seed,
        clusters=6,
        points=1200,
        clustered_points=50 if own else None,
        coverage=0.8 if own else None,
        v_measure=v,
        homogeneity=v,
        completeness=v,
        ari=v,
        seconds=seconds,
    )


MPAP = [row("mpap", "default", v, 0.02, seed) for seed, v in enumerate((0.80, 0.84))]
AP = [row("ap", "default", 0.83), row("ap", "median", 0.6)]


def said(*rows: ClusteringRow, n_classes: int = 6) -> str:
    """Return what stands out."""
    return "\n".join(findings(summarize([*MPAP, *AP, *rows]), n_classes))


def test_runs_become_means_and_a_spread() -> None:
    """Two runs of 0.80 and 0.84 are 0.82 with a deviation of 0.02."""
    mpap = summarize([*MPAP, *AP])[0]

    assert (mpap.method, mpap.runs, mpap.clustered_points) == ("mpap", 2, 50)
    assert mpap.v_measure == pytest.approx(0.82)
    assert mpap.spread == pytest.approx(0.02)
    assert mpap.paper == pytest.approx(0.88)


def test_a_difference_within_the_spread_is_level() -> None:
    """0.82 with a spread of 0.02 is level with 0.83, the better preference; time is told."""
    text = said()

    assert "mpap is level with affinity propagation" in text
    assert "(default, 0.83)" in text
    assert "takes 0.020 s where that takes 1.000 s" in text


@pytest.mark.parametrize(("v", "word"), [(0.7, "0.12 above"), (0.9, "0.08 below")])
def test_a_greater_difference_is_told(v: float, word: str) -> None:
    """Above and below are said where the spread does not explain them."""
    rows = summarize([*MPAP, row("ap", "default", v)])

    text = "\n".join(findings(rows, 6))

    assert f"mpap is {word} affinity propagation" in text


def test_k_means_that_beats_mpap_is_named() -> None:
    """Being told the number of classes is said, and on which histograms it wins."""
    text = said(row("k-means", "raw", 0.8), row("k-means", "square-root", 0.9))

    assert "told that there are 6 classes" in text
    assert "on square-root histograms it beats mpap" in text


def test_k_means_that_does_not_beat_mpap_is_no_victory() -> None:
    """A difference within the spread is not called one."""
    text = said(row("k-means", "raw", 0.83), row("k-means", "square-root", 0.835))

    assert "it beats mpap" not in text


def test_peers_above_mpap_are_named() -> None:
    """HDBSCAN above is said, DenStream below is not."""
    text = said(row("hdbscan", "nearest", 0.87), row("denstream", "default", 0.6))

    assert "above mpap: hdbscan (nearest) 0.87" in text
    assert "denstream" not in text


def test_with_one_class_nothing_is_compared() -> None:
    """One class: the scores mean nothing, and that is what is said."""
    rows = summarize([row("mpap", "default", math.nan), row("ap", "default", math.nan)])

    text = findings(rows, 1)

    assert len(text) == 1
    assert text[0].startswith("one class")


@pytest.mark.parametrize(
    ("cluster_points", "coverage", "expected"),
    [
        (7, 0.9, "cluster-points of mpap: 7, too few"),
        (0, 0.0, "cluster-points of mpap: 0, too few"),
        (60, 0.3, "cluster-points cover 30 % of the points"),
    ],
)
def test_points_that_mpap_hardly_summarizes_are_told(
    cluster_points: int, coverage: float, expected: str
) -> None:
    """Fewer than twenty cluster-points, or less than half of the points covered."""
    few = replace(row("mpap", "default", 0.4), clustered_points=cluster_points, coverage=coverage)

    text = findings(summarize([few]), 2)

    assert len(text) == 1
    assert text[0].startswith(expected)


def test_without_mpap_nothing_is_compared() -> None:
    """What stands out is told of mpap."""
    assert findings(summarize(AP), 6) == []
