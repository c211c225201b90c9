"""Fast Downward's exit codes by name (they are SymK's too)."""

from __future__ import annotations

import signal
from dataclasses import dataclass
from typing import Literal

Kind = Literal["solved", "exhausted", "unsolvable", "budget", "memory", "unsupported", "crashed"]
"""What an exit means for us. `exhausted`: no plan and nothing left to try, a proof only for a complete search with
a safe heuristic. `unsolvable`: the engine proved it."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """A named end of an engine's run."""

    kind: Kind
    text: str


EXITS: dict[int, Outcome] = {
    0: Outcome("solved", "solved"),
    1: Outcome("solved", "plan found, then out of memory"),
    2: Outcome("solved", "plan found, then out of time"),
    3: Outcome("solved", "plan found, then out of memory and time"),
    10: Outcome("unsolvable", "translator proved unsolvable"),
    11: Outcome("unsolvable", "search proved unsolvable"),
    12: Outcome("exhausted", "search space exhausted without a plan"),
    13: Outcome("exhausted", "no plan within the cost bound"),
    20: Outcome("memory", "translator out of memory"),
    21: Outcome("budget", "translator out of time"),
    22: Outcome("memory", "search out of memory"),
    23: Outcome("budget", "search out of time"),
    24: Outcome("memory", "search out of memory and time"),
    30: Outcome("crashed", "translator critical error"),
    31: Outcome("crashed", "translator input error"),
    32: Outcome("crashed", "search critical error"),
    33: Outcome("crashed", "search input error"),
    34: Outcome("unsupported", "search does not support the encoding"),
    35: Outcome("crashed", "driver critical error"),
    36: Outcome("crashed", "driver input error"),
    37: Outcome("unsupported", "driver: not supported"),
}

BUDGET_SPENT = Outcome("budget", "budget spent")
MEMORY_SPENT = Outcome("memory", "memory limit reached")


def outcome_of(code: int) -> Outcome:
    """Return the outcome of an exit code; a negative one is the signal that killed the engine."""
    if code in EXITS:
        return EXITS[code]
    if code < 0:
        try:
            name = signal.Signals(-code).name
        except ValueError:
            name = f"signal {-code}"
        return Outcome("crashed", f"killed by {name}")
    return Outcome("crashed", f"unexplained exit code {code}")
