"""What an extra of the package brings, and the one line for whoever asks for it without."""

from __future__ import annotations

import sys
from importlib.util import find_spec

from smash.problem.errors import Unsupported

EXTRAS: dict[str, tuple[str, ...]] = {
    "analysis": ("matplotlib", "pandas", "jinja2"),
    "parquet": ("pyarrow",),
    "pddl": ("unified_planning", "up_fast_downward", "up_symk", "up_enhsp", "up_aries"),
    "execution": ("pybullet", "pybullet_data", "ompl", "pinocchio", "coal", "toppra", "scipy", "meshcat", "imageio"),
    "cluster": ("dask", "distributed"),
    "gurobi": ("gurobipy", "scipy"),
    "cp-sat": ("ortools",),
    "scip": ("pyscipopt",),
    "clingo": ("clingo",),
    "didp": ("didppy",),
    "docs": ("mkdocs", "material", "mkdocstrings"),
    "gym": ("gymnasium",),
}
"""Extra -> the modules that come with it."""

NO_WHEELS = {"pybullet": (3, 12), "pybullet_data": (3, 12)}
"""Module -> the first Python that it has no wheels for."""
EXECUTION = ("pybullet", "ompl", "pinocchio", "coal", "toppra")
"""What an episode is carried out with."""
TABLES = ("pandas", "matplotlib", "jinja2")
"""What records become tables, charts and pages with."""


class MissingExtra(Unsupported):
    """Something was asked for that needs an extra which is not installed."""

    def __init__(self, who: str, module: str) -> None:
        self.module = module
        super().__init__(f"{who} needs {module}{_wanting(module)}")


def _wanting(module: str) -> str:
    """Return how to get a module, or why it is not to be had here."""
    limit = NO_WHEELS.get(module)
    if limit is None or sys.version_info[:2] < limit:
        return f": {install_line(module)}"
    here, before = ".".join(map(str, sys.version_info[:2])), f"{limit[0]}.{limit[1] - 1}"
    return f", which has no wheels for Python {here}: use Python {before}"


def require(who: str, *modules: str) -> None:
    """Refuse what cannot work here, before anything is done.

    Args:
        who: what was asked for, as its user calls it (`draw`, `smash execute`).
        modules: what it imports; each stands in `EXTRAS`.

    Raises:
        MissingExtra: about the first module that is not there, with the line that installs it.
    """
    for module in modules:
        if not is_there(module):
            raise MissingExtra(who, module)


def is_there(module: str) -> bool:
    """Return whether a module can be imported, without importing it."""
    try:
        return find_spec(module) is not None
    except (ImportError, ValueError):
        return False


def install_line(module: str) -> str:
    """Return the command that installs a module of `EXTRAS`.

    Raises:
        KeyError: where no extra brings it.
    """
    for extra, modules in EXTRAS.items():
        if module in modules:
            return f"pip install 'smash-testbed[{extra}]'"
    raise KeyError(module)


def missing_extra(error: BaseException, who: str) -> MissingExtra | None:
    """Return what to say of an import that failed for want of an extra, or None where it failed otherwise."""
    module = (error.name or "").partition(".")[0] if isinstance(error, ModuleNotFoundError) else ""
    return MissingExtra(who, module) if is_known(module) else None


def is_known(module: str) -> bool:
    """Return whether an extra brings a module."""
    return any(module in modules for modules in EXTRAS.values())
