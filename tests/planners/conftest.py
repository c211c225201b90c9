"""The machine code of the searches, for the tests that need it."""

from time import perf_counter

import pytest

from smash.planners.astar.compiler import Compiler
from smash.planners.precedence.compiler import GraphCompiler

LONGEST = 500
"""Seconds that compiling may take before something is wrong: half a minute on a quiet machine, once a machine."""
COMPILERS = {"machine_code": Compiler, "kernels": GraphCompiler}
"""Fixture -> what makes it."""


def compiled(name):
    """What a fixture gives: no test measures how long it takes to be there."""
    code = COMPILERS[name].code(perf_counter() + LONGEST)
    assert code is not None
    return code


@pytest.fixture(scope="session")
def machine_code():
    """The compiled functions of the search over states."""
    return compiled("machine_code")


@pytest.fixture(scope="session")
def kernels():
    """The compiled kernels of the precedence graph."""
    return compiled("kernels")


def pytest_collection_modifyitems(items):
    """Give the first test that needs compiled code, whichever that is, the time to make it."""
    for item in items:
        needed = len(COMPILERS.keys() & set(getattr(item, "fixturenames", ())))
        if needed:
            item.add_marker(pytest.mark.timeout(needed * LONGEST + 100))
