"""The compiled kernels of the precedence graph, for the tests that need them."""

from time import perf_counter

import pytest

from smash.planners.precedence.compiler import GraphCompiler

LONGEST = 500
"""Seconds that compiling may take before something is wrong: half a minute on a quiet machine, once a machine."""


@pytest.fixture(scope="session")
def kernels():
    """The compiled kernels: no test measures how long they take to be there."""
    code = GraphCompiler.code(perf_counter() + LONGEST)
    assert code is not None
    return code


def pytest_collection_modifyitems(items):
    """Give the first test that needs the kernels, whichever that is, the time to make them."""
    for item in items:
        if "kernels" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.timeout(LONGEST + 100))
