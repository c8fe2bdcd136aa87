"""States of models as files give them back, and damaged ones."""

import json
from collections.abc import Callable
from typing import Any

from mpap_cli.systems.model_parts import ModelState


def reloaded(state: ModelState) -> ModelState:
    """Return the state as it comes out of a file."""
    return ModelState(json.loads(json.dumps(state.header, allow_nan=False)), state.arrays)


def same(one: ModelState, other: ModelState) -> bool:
    """Whether two states have the same bytes."""
    return one.header == other.header and {
        name: (array.dtype, array.shape, array.tobytes()) for name, array in one.arrays.items()
    } == {name: (array.dtype, array.shape, array.tobytes()) for name, array in other.arrays.items()}


def changed(name: str, change: Callable[[Any], Any]) -> Callable[[ModelState], ModelState]:
    """Return a change of one array."""
    return lambda state: ModelState(
        state.header, {**state.arrays, name: change(state.arrays[name].copy())}
    )


def with_header(**values: object) -> Callable[[ModelState], ModelState]:
    """Return a change of the header."""
    return lambda state: ModelState({**state.header, **values}, state.arrays)


def without(name: str) -> Callable[[ModelState], ModelState]:
    """Return what leaves an array out."""
    return lambda state: ModelState(
        state.header, {key: array for key, array in state.arrays.items() if key != name}
    )
