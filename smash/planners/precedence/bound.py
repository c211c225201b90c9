"""The precedence bound of an instance, and the plan that meets it where one fits: what other planners build on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter

from smash.planners.precedence.emptying import Places, emptying_bound, places_decide
from smash.planners.precedence.graph import PrecedenceGraph, build_graph
from smash.planners.precedence.hitting_set import HittingSet, HittingSetSolver
from smash.planners.precedence.schedule import Scheduler, chosen_of
from smash.planners.precedence.waiting import waiting_bound, waits_decide
from smash.problem.model import Action
from smash.problem.problem import Problem
from smash.problem.views.demands import demands_of

ORIGIN = "precedence"
"""The `bound_origin` of the bounds proven here."""
SHORT = 0.2
"""Seconds that any schedule may take."""
CYCLES_SHARE = 0.5
"""Of the time, for the cycles alone where it also matters which piles are emptied, or where blocks wait."""
PLACES_SHARE, PLACES_SECONDS = 0.05, 1.0
"""Of the time left, and the least, for the choices that go with the piles and places of a solution."""
RESERVE = 3.0
"""How often the time of the schedule before is kept for the last one."""


@dataclass(frozen=True, slots=True)
class PrecedenceBound:
    """What the precedence graph says about an instance.

    Attributes:
        bound: no plan costs less.
        relaxed_cost: cost of the cheapest choices found; with enough locations a plan of this cost exists.
        actions: a plan of cost `relaxed_cost`, or None where none was found with the locations there are.
        graph: the precedence graph.
        hitting_set: the choices and the rows that they hit.
    """

    bound: int
    relaxed_cost: int
    actions: tuple[Action, ...] | None
    graph: PrecedenceGraph
    hitting_set: HittingSet

    @property
    def settled(self) -> bool:
        """Whether `actions` is a proven optimum."""
        return self.actions is not None and len(self.actions) <= self.bound


def precedence_bound(
    problem: Problem,
    deadline: float,
    on_plan: Callable[[Sequence[Action]], object] | None = None,
    threads: int = 1,
    on_no_plan: Callable[[], object] | None = None,
    on_bound: Callable[[int], object] | None = None,
) -> PrecedenceBound:
    """Bound the cost of every plan from below, and look for a plan that meets the bound.

    The problem must be feasible (`Problem.infeasible`). Returns within a few milliseconds of
    `deadline`, with a valid bound in any case.

    Args:
        problem: a plain one, of any goal kind.
        deadline: when to stop, in seconds of `time.perf_counter`.
        on_plan: called with every better plan at once.
        threads: the solver's threads.
        on_no_plan: called once, as soon as the first choices do not fit the locations there are.
        on_bound: called at once with the first bound and every better one.
    """
    graph = build_graph(problem)
    plans = _Plans(problem, graph, deadline, on_plan, on_no_plan)
    tell = on_bound or (lambda bound: None)
    tell(graph.base_cost)
    solver = HittingSetSolver(graph, threads, lambda bound: tell(graph.base_cost + bound))
    plans.offer(solver.start(deadline), 0.1)
    placing = places_decide(problem)
    waiting = waits_decide(problem)
    shared = placing or waiting
    until = perf_counter() + CYCLES_SHARE * (deadline - perf_counter()) if shared else deadline - plans.reserve
    found = solver.solve(until, plans.offer)
    plans.offer(found.chosen, 1.0)
    relaxed = graph.base_cost + sum(graph.choices[choice].cost for choice in found.chosen)
    bound = graph.base_cost + found.bound
    if shared and (plans.best is None or len(plans.best) > bound):
        known = bound

        def raise_bound(better: int) -> None:
            if better > known:
                tell(better)

        if placing:
            joined = emptying_bound(problem, graph, found.cycles, deadline, raise_bound, threads, plans.offer_places)
        else:
            joined = waiting_bound(problem, deadline, raise_bound, threads, plans.take)
        bound = max(bound, joined)
    return PrecedenceBound(bound, relaxed, plans.best, graph, found)


class _Plans:
    """Schedules the choices that come in; scheduling takes no more than a small share of the time so far."""

    def __init__(
        self,
        problem: Problem,
        graph: PrecedenceGraph,
        deadline: float,
        on_plan: Callable[[Sequence[Action]], object] | None,
        on_no_plan: Callable[[], object] | None,
    ) -> None:
        self.problem = problem
        self.graph = graph
        self.deadline = deadline
        self.on_plan = on_plan
        self.on_no_plan = on_no_plan
        self.best: tuple[Action, ...] | None = None
        self._scheduled: set[int] | None = None
        self._idle_until = 0.0
        self._took = 0.0

    @property
    def reserve(self) -> float:
        """Seconds to keep for the last schedule, at most a tenth of the time left."""
        return min(RESERVE * self._took, 0.1 * max(0.0, self.deadline - perf_counter()))

    def offer_places(self, places: Places) -> int | None:
        """Schedule the cheapest choices that build and leave blocks where it is said; return the best plan's cost."""
        graph = build_graph(self.problem, demands_of(self.problem.posed, places.kept, places.at))
        solver = HittingSetSolver(graph)
        now = perf_counter()
        seconds = max(PLACES_SECONDS, PLACES_SHARE * (self.deadline - now))
        found = solver.solve(min(self.deadline, now + seconds))
        if self.best is None or graph.base_cost + solver.cost(found.chosen) < len(self.best):
            self._schedule(graph, found.chosen, 0.1)
        return None if self.best is None else len(self.best)

    def offer(self, chosen: set[int], share: float = 0.0) -> None:
        """Schedule a choice, within a `share` of the time left; with share 0 only if that is quick enough."""
        if chosen == self._scheduled or (perf_counter() < self._idle_until and not share):
            return
        self._scheduled = set(chosen)
        self._schedule(self.graph, chosen, share)

    def _schedule(self, graph: PrecedenceGraph, chosen: set[int], share: float) -> None:
        started = perf_counter()
        scheduler = Scheduler(self.problem, chosen_of(graph.choices, chosen), graph.demands)
        limit = min(self.deadline, started + max(SHORT, self.reserve, share * (self.deadline - started)))
        actions = scheduler.plan(limit)
        if actions is None and perf_counter() > limit:
            self._scheduled = None  # with more time it may fit
        if actions is not None and self.problem.open_rest is not None and not self._accepted(actions):
            actions = None
        self._took = perf_counter() - started
        self._idle_until = perf_counter() + 5 * self._took
        if actions is None and self.best is None and self.on_no_plan is not None:
            self.on_no_plan()
            self.on_no_plan = None
        if actions is not None:
            self.take(actions)

    def take(self, actions: Sequence[Action]) -> None:
        """Take up a plan where it is better than the best one."""
        if self.best is None or len(actions) < len(self.best):
            self.best = tuple(actions)
            if self.on_plan is not None:
                self.on_plan(self.best)

    def _accepted(self, actions: Sequence[Action]) -> bool:
        """Whether the law takes a plan: where a block rests for good is not all in the graph for every goal."""
        return self.problem.law.check(actions).accepted
