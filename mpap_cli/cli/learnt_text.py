"""What ``mpap learn`` and ``mpap merge`` print: counts, and the most dangerous clusters."""

from mpap_cli.commands.learning.summary import Learnt, LearntImages, LearntScans
from mpap_cli.outputs.console import shown
from mpap_cli.outputs.text_table import aligned, count, printable
from mpap_cli.systems.cluster_rows import ClusterRow

SHOWN_CLUSTERS = 8


def learnt_text(learnt: Learnt) -> str:
    """Lay out what was learnt, sensor by sensor."""
    presses = "no bumper" if learnt.n_presses is None else count(learnt.n_presses, "press")
    said = f"{count(learnt.n_logs, 'log')}, {presses}"
    lines = []
    if learnt.scans is not None:
        lines += _scan_lines(learnt.scans, said, learnt.profile)
    if learnt.images is not None:
        lines += _image_lines(learnt.images, said, learnt.profile)
    lines.append(f"results: {printable(str(learnt.folder))}")
    return "".join(f"{line}\n" for line in lines)


def _scan_lines(scans: LearntScans, said: str, profile: str) -> list[str]:
    """Say what is known of laser scans."""
    summary = (
        f"{count(scans.n_scans, 'scan')} of {said}; {count(len(scans.clusters), 'cluster')} of "
        f"{count(scans.n_cluster_points, 'cluster-point')} "
        f"({count(scans.n_meta_points, 'meta-point')}), profile {profile}"
    )
    return [summary, *_cluster_lines(scans.clusters, ("p(collision)", "scans"))]


def _image_lines(images: LearntImages, said: str, profile: str) -> list[str]:
    """Say what is known of camera images."""
    summary = (
        f"{count(images.n_images, 'image')} ({images.n_patches:,} patches) of {said}; "
        f"{count(len(images.clusters), 'cluster')} of {count(images.n_exemplars, 'exemplar')} "
        f"({count(images.n_outliers, 'outlier')} in the reservoir), profile {profile}"
    )
    return [summary, *_cluster_lines(images.clusters, ("p(obstacle)", "patches"))]


def _cluster_lines(clusters: list[ClusterRow], names: tuple[str, str]) -> list[str]:
    """Lay out the clusters with the highest probability."""
    ranked = sorted(clusters, key=_rank)[:SHOWN_CLUSTERS]
    cells = [("cluster", names[0], "[95 % by visits]", names[1], "presses", "visits", "exemplar")]
    cells += [
        (
            str(row.cluster),
            shown(row.p_collision),
            f"[{shown(row.p_low)},{shown(row.p_high)}]",
            f"{row.observations:,}",
            str(row.presses),
            str(row.visits),
            f"{row.exemplar_log}@{row.exemplar_time_s:.1f}",
        )
        for row in ranked
    ]
    lines = list(aligned(cells, right={0, 1, 3, 4, 5}))
    left = len(clusters) - len(ranked)
    return [*lines, f"and {left} more in clusters.csv"] if left > 0 else lines


def _rank(row: ClusterRow) -> tuple[float, int]:
    """Sort the most dangerous clusters to the front, those without labels to the end."""
    return (1.0 if row.p_collision is None else -row.p_collision, row.cluster)
