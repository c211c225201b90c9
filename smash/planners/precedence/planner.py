"""`precedence`: proven optima without a time index, from the cycles of one precedence graph (`docs/theory.md`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from smash.planners.greedy import greedy_method
from smash.planners.protocol import Method, MethodPlanner, Settings, SolveLog, left, plain
from smash.problem.problem import Problem

GREEDY_SHARE = 0.1
"""Share of the time left that the greedy planner gets where the exact choices need more buffers than there are."""
BLOCK_SECONDS = 2e-4
"""With less time than this per block there may be none for the graph and a schedule: a greedy plan comes first."""


class PrecedencePlanner(MethodPlanner):
    """Fewest choices that hit every cycle of the precedence graph, scheduled with the locations there are.

    Where the schedule fits, its plan is optimal. Where it needs more buffers than there are, the value
    is a lower bound, and the details say so.
    """

    summary: ClassVar[str] = "exact: cheapest hitting set of the precedence graph's cycles, no time index"
    proves: ClassVar[bool] = True
    open_goals: ClassVar[bool] = True
    gentle: ClassVar[bool] = True

    def prepare(self) -> None:
        """Load the solvers and the arrays, so that no import is counted as planning."""
        from smash.planners.precedence import bound, hitting_set, maxsat  # noqa: F401

    def methods(self, problem: Problem, settings: Settings) -> Sequence[Method]:
        """Return the hitting set alone."""

        def run(problem: Problem, log: SolveLog, until: float) -> None:
            _hitting_set(problem, settings, log, until)

        return (Method("hitting set", plain, run),)


def _hitting_set(problem: Problem, settings: Settings, log: SolveLog, until: float) -> None:
    """Bound the cost of every plan and look for one that meets the bound; fall back on greedy plans where none fits."""
    from smash.planners.precedence.bound import ORIGIN, precedence_bound

    fallback = greedy_method(settings, GREEDY_SHARE)
    hurried = left(until) < BLOCK_SECONDS * len(problem.instance.blocks)
    if hurried:
        fallback.run(problem, log, fallback.until(until))
    found = precedence_bound(
        problem,
        until,
        lambda actions: log.offer(actions, "exact"),
        settings.threads,
        None if hurried else lambda: fallback.run(problem, log, fallback.until(until)),
        lambda bound: log.prove(bound, ORIGIN),
    )
    log.details |= {
        "choices": len(found.graph.choices),
        "rows": len(found.hitting_set.rows),
        "rounds": dict(found.hitting_set.rounds),
        "prover": found.hitting_set.prover,
        "relaxed_cost": found.relaxed_cost,
    }
    if found.actions is None:
        cost, count = max(found.relaxed_cost, found.bound), len(problem.instance.buffers)
        buffers = "1 buffer" if count == 1 else f"{count} buffers"
        log.details["reason"] = f"no plan of cost {cost} found with {buffers}; the value is a lower bound"
