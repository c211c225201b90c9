"""What was simulated by one engine and what by another do not make one table; neither do episodes of two robots."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from smash.problem.errors import SmashError


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


def require_one_engine(where: str, what: str, engines: Iterable[str]) -> None:
    """Refuse records of several engines.

    Args:
        where: where they are from, for the message.
        what: what they are, for the message (`episodes`, `topples`).
        engines: that of each.

    Raises:
        MixedEngines: where there are several.
    """
    counts = Counter(engines)
    if len(counts) > 1:
        raise MixedEngines(where, what, counts)


def require_one_robot(where: str, what: str, robots: Iterable[str]) -> None:
    """Refuse records of several robots.

    Args:
        where: where they are from, for the message.
        what: what they are, for the message.
        robots: that of each.

    Raises:
        MixedRobots: where there are several.
    """
    counts = Counter(robots)
    if len(counts) > 1:
        raise MixedRobots(where, what, counts)
