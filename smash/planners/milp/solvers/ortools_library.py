"""Loading CP-SAT beside HiGHS: two packages that each bring a library of the same name, of another version.

The loader takes a library that is there for every one of its name, so that ortools finds highspy's `libhighs.so.1` and
lacks what only its own has. So highspy comes first, with all that it needs bound to its own library; then ortools' own
is loaded by its path, for all to see; then ortools.
"""

from __future__ import annotations

import ctypes
import os
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from smash.problem.extras import require


@cache
def load_cp_model() -> ModuleType:
    """Return the module `ortools.sat.python.cp_model`.

    Raises:
        MissingExtra: where ortools is not installed.
    """
    require("CP-SAT", "ortools")
    import highspy  # noqa: F401 - it must be bound before ortools' library is there for all

    found = find_spec("ortools")
    for folder in (found.submodule_search_locations or ()) if found is not None else ():
        for library in Path(folder, ".libs").glob("libhighs.so.*"):
            ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL | os.RTLD_NOW)
    from ortools.sat.python import cp_model

    module: ModuleType = cp_model
    return module
