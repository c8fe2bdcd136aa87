"""Numbers the paper prints, to stand beside ours."""

TABLE_4: dict[tuple[str, int], tuple[float, float]] = {
    ("min-value", 6): (0.86, 0.89),
    ("min-value", 12): (0.89, 0.88),
    ("max-value", 6): (0.90, 0.91),
    ("max-value", 12): (0.90, 0.87),
    ("mean-value", 6): (0.87, 0.69),
    ("mean-value", 12): (0.85, 0.81),
    ("global-diff", 6): (0.90, 0.90),
    ("global-diff", 12): (0.88, 0.65),
    ("seq-diff", 6): (0.77, 0.78),
    ("seq-diff", 12): (0.78, 0.70),
}
"""Area under the ROC curve by feature and number of bins: (indoor, outdoor); table 4.

The paper seems to score the scans it learnt from, so only ``in-sample`` compares.
"""
