"""Learn from robot logs, without labels: surroundings, collisions, novelty.

The commands are functions here, imported when they are first used. Each takes records and
returns one; nothing is printed, warnings go through ``logging``.

Examples
--------
>>> import mpap_cli
>>> selection = mpap_cli.LogSelection(logs=("day1.bag", "day2.bag"))
>>> request = mpap_cli.LearnRequest(out=Path("mpap-out"))  # doctest: +SKIP
>>> learnt = mpap_cli.learn(selection, mpap_cli.SettingsRequest(), request)  # doctest: +SKIP
>>> [row.p_collision for row in learnt.clusters]  # doctest: +SKIP
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mpap_cli.commands.cluster import ClusterRequest, cluster
    from mpap_cli.commands.compare import CompareRequest, compare
    from mpap_cli.commands.evaluate import EvaluateRequest, evaluate
    from mpap_cli.commands.extract import extract
    from mpap_cli.commands.extracting.request import ExtractRequest
    from mpap_cli.commands.fleet.learn_merged import MergeRequest, learn_merged
    from mpap_cli.commands.info import info
    from mpap_cli.commands.inputs.selection import LogSelection
    from mpap_cli.commands.learn import LearnRequest, learn
    from mpap_cli.commands.merge import merge
    from mpap_cli.commands.novelty import NoveltyRequest, novelty
    from mpap_cli.commands.predict import predict
    from mpap_cli.commands.predicting.request import PredictRequest
    from mpap_cli.commands.reproduce import reproduce
    from mpap_cli.commands.reproducing.request import ReproduceRequest
    from mpap_cli.commands.settings import SettingsRequest
    from mpap_cli.commands.similar import SimilarRequest, similar
    from mpap_cli.commands.simulate import simulate

__version__ = "0.1.0"

_MODULES = {
    "cluster": ("cluster", "ClusterRequest"),
    "compare": ("compare", "CompareRequest"),
    "evaluate": ("evaluate", "EvaluateRequest"),
    "extract": ("extract",),
    "extracting.request": ("ExtractRequest",),
    "fleet.learn_merged": ("MergeRequest", "learn_merged"),
    "info": ("info",),
    "inputs.selection": ("LogSelection",),
    "learn": ("learn", "LearnRequest"),
    "merge": ("merge",),
    "novelty": ("novelty", "NoveltyRequest"),
    "predict": ("predict",),
    "predicting.request": ("PredictRequest",),
    "reproduce": ("reproduce",),
    "reproducing.request": ("ReproduceRequest",),
    "settings": ("SettingsRequest",),
    "similar": ("similar", "SimilarRequest"),
    "simulate": ("simulate",),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}

__all__ = [
    "ClusterRequest",
    "CompareRequest",
    "EvaluateRequest",
    "ExtractRequest",
    "LearnRequest",
    "LogSelection",
    "MergeRequest",
    "NoveltyRequest",
    "PredictRequest",
    "ReproduceRequest",
    "SettingsRequest",
    "SimilarRequest",
    "cluster",
    "compare",
    "evaluate",
    "extract",
    "info",
    "learn",
    "learn_merged",
    "merge",
    "novelty",
    "predict",
    "reproduce",
    "similar",
    "simulate",
]


def __getattr__(name: str) -> Any:
    """Import a function or record when it is first asked for."""
    if name not in _MODULE_OF:
        msg = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(msg)
    return getattr(importlib.import_module(f"{__name__}.commands.{_MODULE_OF[name]}"), name)


def __dir__() -> list[str]:
    """List what can be asked for."""
    return sorted([*globals(), *__all__])
