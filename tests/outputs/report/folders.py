"""Results folders written by hand, as commands leave them."""

from collections.abc import Mapping
from pathlib import Path

from mpap_cli.outputs.results_folder import ResultsFolder
from mpap_cli.outputs.results_reader import InputFile

CLUSTERS = (
    "sensor,feature,bins,profile,cluster,observations,collisions,non_collisions,presses,visits,"
    "p_collision,p_low,p_high,meta_points,exemplar_log,exemplar_time_s,exemplar_stamp_ns,"
    "first_seen_s,last_seen_s\n"
)
NOVELTY = (
    "log,log_index,sensor,window_start_s,window_end_s,start_stamp_ns,observations,novel,"
    "percent_novel,percent_unknown_at_start,clusters\n"
)
TIMELINE = "log,log_index,time_s,p_collision,predicted,truth,alarm\n"


def cluster_line(cluster: int, p: str, presses: int, log: str = "day1.bag") -> str:
    """Return a row of clusters.csv."""
    return (
        f"scan,f,12,robust,{cluster},{10 * cluster + 10},1,9,{presses},3,{p},,,2,{log},1.5,15,1,2\n"
    )


def write(out: Path, command: str, texts: Mapping[str, str], log: str = "day1.bag") -> Path:
    """Leave the results of a command."""
    with ResultsFolder(out, command) as results:
        for name, text in texts.items():
            results.path(name).write_text(text, encoding="utf-8")
        results.commit({"theta": "0.1"}, [InputFile(log, 3, "ab")])
    return results.folder
