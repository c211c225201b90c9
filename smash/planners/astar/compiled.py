"""The search's functions, interpreted or compiled by numba: one source, and numba imported only where it pays.

The compiled ones are copies whose calls to each other lead to compiled ones. Their machine code is cached
beside the source, so that it is made once a machine (`python -m smash.planners.astar.warm`).
"""

from __future__ import annotations

import types
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from smash.planners.astar import bound, layer, moves, search, state

MODULES = (state, bound, moves, search, layer)


class Code(NamedTuple):
    """What the drivers call."""

    unpack: Callable[..., None]
    settle: Callable[..., int]
    apply_move: Callable[..., int]
    lower_bound: Callable[..., int]
    file_state: Callable[..., bool]
    file_node: Callable[..., int]
    file_again: Callable[..., None]
    expand_some: Callable[..., int]
    expand_layer: Callable[..., int]


INTERPRETED = Code(
    state.unpack,
    state.settle,
    state.apply_move,
    bound.lower_bound,
    search.file_state,
    search.file_node,
    search.file_again,
    search.expand_some,
    layer.expand_layer,
)


def compiled_code() -> Code:
    """Return compiled copies of the search's functions; each is compiled, or loaded, when first called."""
    from numba import njit

    _drop_stale_cache()
    own = {module.__name__ for module in MODULES}
    scope: dict[str, Any] = {}
    for module in MODULES:
        scope.update({name: value for name, value in vars(module).items() if not name.startswith("__")})
    for name, function in list(scope.items()):
        if isinstance(function, types.FunctionType) and function.__module__ in own:
            copy = types.FunctionType(function.__code__, scope, name, function.__defaults__)
            copy.__module__ = function.__module__
            copy.__qualname__ = function.__qualname__
            scope[name] = njit(cache=True, nogil=True)(copy)
    return Code(*(scope[name] for name in Code._fields))


def _drop_stale_cache() -> None:
    """Delete machine code older than any of the sources: numba looks only at the file of the function itself."""
    sources = [Path(module.__file__) for module in MODULES if module.__file__]
    newest = max(source.stat().st_mtime for source in sources)
    for index in (sources[0].parent / "__pycache__").glob("*.nbi"):
        if index.stat().st_mtime < newest:
            index.unlink(missing_ok=True)
