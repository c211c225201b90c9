"""What an extra of the package brings, and the one line for whoever asks for it without."""

from __future__ import annotations

import sys
from importlib.util import find_spec

from smash.problem.errors import SmashError, Unsupported

EXTRAS: dict[str, tuple[str, ...]] = {
    "analysis": ("matplotlib", "pandas", "jinja2"),
    "parquet": ("pyarrow",),
    "pddl": ("unified_planning", "up_fast_downward", "up_symk", "up_enhsp", "up_aries"),
    "execution": ("pybullet", "ompl", "pinocchio", "coal", "toppra", "scipy", "meshcat", "imageio"),
    "mujoco": ("mujoco",),
    "cluster": ("dask", "distributed"),
    "gurobi": ("gurobipy", "scipy"),
    "cp-sat": ("ortools",),
    "scip": ("pyscipopt",),
    "clingo": ("clingo",),
    "didp": ("didppy",),
    "docs": ("mkdocs", "material", "mkdocstrings"),
    "gym": ("gymnasium",),
    "ros": ("mcap", "mcap_ros2"),
}
"""Extra -> the modules that come with it."""

NO_WHEELS = {"pybullet": (3, 12)}
"""Module -> the first Python that it has no wheels for."""
INSTEAD = {"pybullet": "mujoco"}
"""Module -> what does the same where it has no wheels."""
EXECUTION = ("ompl", "pinocchio", "coal", "toppra")
"""What an episode is carried out with, beside an engine."""
ENGINES = {"pybullet": "pybullet", "mujoco": "mujoco"}
"""What simulates an episode -> its module; the first one that is there is used where none is named."""
TABLES = ("pandas", "matplotlib", "jinja2")
"""What records become tables, charts and pages with."""


class MissingExtra(Unsupported):
    """Something was asked for that needs an extra which is not installed."""

    def __init__(self, who: str, module: str) -> None:
        self.module = module
        super().__init__(f"{who} needs {module}{_wanting(module)}")


def _wanting(module: str) -> str:
    """Return how to get a module, or why it is not to be had here."""
    if not _has_no_wheels(module):
        return f": {install_line(module)}"
    limit = NO_WHEELS[module]
    here, before = ".".join(map(str, sys.version_info[:2])), f"{limit[0]}.{limit[1] - 1}"
    way_out = f", which has no wheels for Python {here}: use Python {before}"
    other = INSTEAD.get(module)
    return way_out if other is None else f"{way_out}, or {other}: {install_line(other)}"


def _has_no_wheels(module: str) -> bool:
    return module in NO_WHEELS and sys.version_info[:2] >= NO_WHEELS[module]


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


def default_engine() -> str:
    """Return the engine that is used where none is named: the first one that is there, else the one to install."""
    there = [engine for engine, module in ENGINES.items() if is_there(module)]
    to_be_had = [engine for engine, module in ENGINES.items() if not _has_no_wheels(module)]
    return (there or to_be_had)[0]


def require_engine(engine: str) -> None:
    """Refuse an engine that cannot simulate anything here.

    Raises:
        MissingExtra: where it is not there.
        SmashError: where there is none of that name.
    """
    if engine not in ENGINES:
        raise SmashError(f"engine: {engine!r} is not allowed; {' or '.join(map(repr, ENGINES))} is allowed")
    require(f"the engine {engine}", ENGINES[engine])


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
