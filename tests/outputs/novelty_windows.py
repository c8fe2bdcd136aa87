"""Windows of novelty for tests of what is made of them."""

from mpap_cli.evaluation.novelty import NoveltyRow


def windows(*percents: float) -> list[NoveltyRow]:
    """Return windows of a minute and 100 observations, one after the other."""
    return [
        NoveltyRow(
            log="a.bag",
            log_index=0,
            sensor="image",
            window_start_s=5.0 + 60 * index,
            window_end_s=65.0 + 60 * index,
            start_stamp_ns=0,
            observations=100,
            novel=round(percent),
            percent_novel=percent,
            percent_unknown_at_start=None,
            clusters=1,
        )
        for index, percent in enumerate(percents)
    ]
