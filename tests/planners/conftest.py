"""The machine code of the search, for the tests that need it."""

from time import perf_counter

import pytest

from smash.planners.astar.compiler import Compiler

LONGEST = 500
"""Seconds that compiling may take before something is wrong: half a minute on a quiet machine, once a machine."""


@pytest.fixture(scope="session")
def machine_code():
    """The compiled functions: no test measures how long they take to be there."""
    code = Compiler.code(perf_counter() + LONGEST)
    assert code is not None
    return code


def pytest_collection_modifyitems(items):
    """Give the first test that needs the machine code, whichever that is, the time to make it."""
    for item in items:
        if "machine_code" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.timeout(LONGEST + 100))
