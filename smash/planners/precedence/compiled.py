"""The kernels of the precedence graph, interpreted or compiled (`smash/planners/compiling.py`)."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from smash.planners.compiling import compiled_functions
from smash.planners.precedence.kernels import order, paths, ranks

MODULES = (paths, order, ranks)


class Kernels(NamedTuple):
    """What the hitting set calls."""

    cheapest_cycle: Callable[..., bool]
    anneal_some: Callable[..., int]
    best_rank: Callable[..., tuple[int, int, int]]
    compiled: bool


INTERPRETED = Kernels(paths.cheapest_cycle, order.anneal_some, ranks.best_rank, compiled=False)


def compiled_kernels() -> Kernels:
    """Return compiled copies of the kernels; each is compiled, or loaded, when first called."""
    scope = compiled_functions(MODULES)
    return Kernels(scope["cheapest_cycle"], scope["anneal_some"], scope["best_rank"], compiled=True)
