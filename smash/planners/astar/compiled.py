"""The search's functions, interpreted or compiled (`smash/planners/compiling.py`)."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from smash.planners.astar import bound, layer, moves, patterns, search, state
from smash.planners.compiling import compiled_functions

MODULES = (state, bound, moves, patterns, search, layer)


class Code(NamedTuple):
    """What the drivers call."""

    unpack: Callable[..., None]
    pack: Callable[..., None]
    settle: Callable[..., int]
    apply_move: Callable[..., int]
    lower_bound: Callable[..., int]
    file_state: Callable[..., bool]
    file_node: Callable[..., int]
    file_again: Callable[..., None]
    expand_some: Callable[..., int]
    expand_layer: Callable[..., int]
    mark_goals: Callable[..., int]
    spread: Callable[..., int]


INTERPRETED = Code(
    state.unpack,
    state.pack,
    state.settle,
    state.apply_move,
    bound.lower_bound,
    search.file_state,
    search.file_node,
    search.file_again,
    search.expand_some,
    layer.expand_layer,
    patterns.mark_goals,
    patterns.spread,
)


def compiled_code() -> Code:
    """Return compiled copies of the search's functions; each is compiled, or loaded, when first called."""
    scope = compiled_functions(MODULES)
    return Code(*(scope[name] for name in Code._fields))
