"""`smash.problem.suites` of 0.1: `smash.problem.sets.suites`."""

from smash.problem.buffers import with_buffers
from smash.problem.sets.suites import (
    PAPER_SUITES,
    SUITE_COUNT,
    SUITE_SEED,
    SUITES,
    generated_names,
    made_again,
    read_suite,
    suite_files,
    suite_names,
)

__all__ = [
    "PAPER_SUITES",
    "SUITES",
    "SUITE_COUNT",
    "SUITE_SEED",
    "generated_names",
    "made_again",
    "read_suite",
    "suite_files",
    "suite_names",
    "with_buffers",
]
