"""Experiments run small, each once for all tests that look at what it found."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mpap_cli.commands.reproducing.bench import Bench
from mpap_cli.commands.reproducing.experiments import EXPERIMENTS
from mpap_cli.commands.reproducing.request import ReproduceRequest
from mpap_cli.commands.runtime import one_thread_each

Tried = Callable[..., Bench]


@pytest.fixture(scope="session")
def tried(tmp_path_factory: pytest.TempPathFactory) -> Tried:
    """Return what runs an experiment small: its name, items (or all), fields of the request."""
    benches: dict[tuple[object, ...], Bench] = {}

    def run(name: str, *items: str, **fields: Any) -> Bench:
        key = (name, items, *sorted(fields.items()))
        if key not in benches:
            folder: Path = tmp_path_factory.mktemp(name.replace(" ", "-"))
            scratch = folder / "scratch"
            scratch.mkdir()
            experiment = next(one for one in EXPERIMENTS if one.name == name)
            request = ReproduceRequest(out=folder, short=True, only=items, **fields)
            bench = Bench(name, request, experiment.wanted(items), folder, scratch)
            with one_thread_each():
                experiment.run(bench)
            benches[key] = bench
        return benches[key]

    return run
