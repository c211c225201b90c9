"""Planners by name, from the `smash.planners` entry-point group; nothing is imported before it is asked for.

`NAME:ENCODING` is the planner NAME on another PDDL encoding, where it has a choice (`with_encoding`).
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import EntryPoint

from smash.planners.protocol import Planner, Settings, why_refused
from smash.problem.entry_points import entry_points_of
from smash.problem.errors import SmashError, Unsupported
from smash.problem.extras import missing_extra
from smash.problem.problem import Problem

GROUP = "smash.planners"
DEFAULT = "smash"
COMMAND = "command"
"""The planner that runs a program outside, which `Settings.command` names."""


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
        SmashError: where `NAME:ENCODING` names an encoding that is none.
    """
    registered = _registered()
    plain, _, encoding = (name, "", "") if name in registered else name.partition(":")
    if plain not in registered:
        raise UnknownPlanner(name, sorted(registered))
    try:
        planner: Planner = registered[plain].load()()
    except (ImportError, AttributeError) as error:
        missing = missing_extra(error, f"planner {name!r}")
        raise missing or Unsupported(f"planner {name!r} is not installed: {error}") from None
    if plain != name:
        choose: Callable[[str], Planner] | None = getattr(planner, "with_encoding", None)
        if choose is None:
            raise UnknownPlanner(name, sorted(registered))
        planner = choose(encoding)
    missing = getattr(planner, "missing", None)
    lacks = missing() if missing is not None else None
    if lacks:
        raise Unsupported(f"planner {name!r} is not installed: {lacks}")
    return planner


def make_ready(planner: Planner, name: str, problem: Problem, settings: Settings) -> None:
    """Ask whether a planner takes a problem, then have it load what it loads once: all that precedes its clock.

    Args:
        planner: the planner.
        name: what it is called.
        problem: what it is to plan.
        settings: how.

    Raises:
        Unsupported: where it does not take the problem or the settings.
        MissingExtra: where the solver that it is told to use is not installed.
    """
    reason = why_refused(planner, problem, settings)
    if reason:
        raise Unsupported(f"planner {name!r}: unsupported: {reason}")
    prepare = getattr(planner, "prepare", None)
    if prepare is not None:
        prepare()
    load_solver = getattr(planner, "load_solver", None)
    if load_solver is not None:
        load_solver(settings)


def why_unknown(name: str) -> str | None:
    """Return why there is no planner called `name`, or None; one that is broken or not installed is known."""
    try:
        if name not in _registered():
            get_planner(name)
    except Unsupported:
        return None
    except SmashError as error:
        return str(error)
    return None


def _registered() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in entry_points_of(GROUP)}
