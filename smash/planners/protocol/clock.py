"""How a budget becomes a deadline, on the clock of `time.perf_counter` [s]."""

from __future__ import annotations

from time import perf_counter

SPARE_SECONDS = 0.05
"""Kept back from a budget for the end of the last solver or search, and for the law to check the last plan."""
SPARE_SHARE = 0.1
"""No more than this share of a budget is kept back."""


def deadline_of(budget: float, kept_back: float = 0.0) -> float:
    """Return when a solve that begins now has to end.

    Args:
        budget: seconds of wall time.
        kept_back: share of the budget that is kept back where that is more than `SPARE_SECONDS`.
    """
    return perf_counter() + budget - max(min(SPARE_SECONDS, SPARE_SHARE * budget), kept_back * budget)


def left(deadline: float) -> float:
    """Return the seconds until `deadline`, negative where it has passed."""
    return deadline - perf_counter()
