"""`smash.problem.generators` of 0.1: `smash.problem.sets.generators`."""

from smash.problem.sets.generators import (
    BENCHMARKS,
    EXTRA,
    STACKS,
    block_names,
    buffer_names,
    cut,
    draw_arrangement,
    generate,
    multi_goal,
    single_goal,
)

__all__ = [
    "BENCHMARKS",
    "EXTRA",
    "STACKS",
    "block_names",
    "buffer_names",
    "cut",
    "draw_arrangement",
    "generate",
    "multi_goal",
    "single_goal",
]
