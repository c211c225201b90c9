"""What was simulated by one engine and what by another do not make one table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from smash.problem.errors import SmashError


class MixedEngines(SmashError):
    """Records of several engines where those of one make sense."""

    def __init__(self, where: str, what: str, counts: Counter[str]) -> None:
        told = ", ".join(f"{count} by {engine}" for engine, count in sorted(counts.items()))
        super().__init__(f"{where}: {what} of several engines ({told}) make no table; keep each in a directory")


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
