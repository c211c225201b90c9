"""What was simulated by one engine and what by another do not make one table; neither do episodes of two robots."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Protocol

from smash.problem.errors import SmashError


class Simulated(Protocol):
    """What says by what it was simulated, and with which robot."""

    @property
    def engine(self) -> str:
        """Name of the engine."""

    @property
    def robot(self) -> str:
        """Label of the robot."""


class MixedEngines(SmashError):
    """Records of several engines where those of one make sense."""

    def __init__(self, where: str, what: str, counts: Counter[str]) -> None:
        super().__init__(_several(where, what, "engines", counts))


class MixedRobots(SmashError):
    """Records of several robots where those of one make sense."""

    def __init__(self, where: str, what: str, counts: Counter[str]) -> None:
        super().__init__(_several(where, what, "robots", counts))


def _several(where: str, what: str, kind: str, counts: Counter[str]) -> str:
    told = ", ".join(f"{count} by {name}" for name, count in sorted(counts.items()))
    return f"{where}: {what} of several {kind} ({told}) make no table; keep each in a directory"


def require_alike(where: str, what: str, records: Iterable[Simulated]) -> None:
    """Refuse records of several engines, or of several robots.

    Args:
        where: where they are from, for the message.
        what: what they are, for the message (`episodes`, `topples`).
        records: of episodes or trials.

    Raises:
        MixedEngines: where there are several engines.
        MixedRobots: where there are several robots.
    """
    origins = [(record.engine, record.robot) for record in records]
    engines, robots = (Counter(origin[part] for origin in origins) for part in (0, 1))
    if len(engines) > 1:
        raise MixedEngines(where, what, engines)
    if len(robots) > 1:
        raise MixedRobots(where, what, robots)
