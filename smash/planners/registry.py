"""Planners by name, from the `smash.planners` entry-point group; nothing is imported before it is asked for."""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points

from smash.planners.protocol import Planner
from smash.problem.errors import SmashError, Unsupported

GROUP = "smash.planners"
DEFAULT = "smash"


class UnknownPlanner(SmashError):
    """A name that no planner has; the message lists the valid ones."""

    def __init__(self, name: str, known: list[str]) -> None:
        self.name = name
        self.known = known
        super().__init__(f"no planner is called {name!r}; known: {', '.join(known)}")


def planner_names() -> list[str]:
    """Return the names of all registered planners, sorted."""
    return sorted(_registered())


def get_planner(name: str) -> Planner:
    """Return a new planner object.

    Raises:
        UnknownPlanner: where no planner has this name.
        Unsupported: where its module or engine is not installed.
    """
    registered = _registered()
    if name not in registered:
        raise UnknownPlanner(name, sorted(registered))
    try:
        planner: Planner = registered[name].load()()
    except (ImportError, AttributeError) as error:
        raise Unsupported(f"planner {name!r} is not installed: {error}") from None
    missing = getattr(planner, "missing", None)
    lacks = missing() if missing is not None else None
    if lacks:
        raise Unsupported(f"planner {name!r} is not installed: {lacks}")
    return planner


def _registered() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in entry_points(group=GROUP)}
