"""The machine code of the search, and plans that leave something to be improved."""

from time import perf_counter

import pytest

from smash.planners.astar.compiler import Compiler

LONGEST = 500
"""Seconds that compiling may take before something is wrong."""


@pytest.fixture(scope="session")
def machine_code():
    """The compiled functions: no test measures how long they take to be there."""
    code = Compiler.code(perf_counter() + LONGEST)
    assert code is not None
    return code
