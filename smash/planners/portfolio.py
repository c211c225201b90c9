"""`smash`, the default planner: greedy at once, then the exact methods, cheapest first, and beams, under one budget."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any, ClassVar

from smash.planners.astar import BeamSearch, StateSearch
from smash.planners.greedy import greedy_steps
from smash.planners.protocol import BasePlanner, IncumbentLog, OnIncumbent, PlanResult, Relay, SolveOptions
from smash.problem.actions.registry import FAMILY, is_plain
from smash.problem.model import Instance
from smash.problem.views.numbered import Indexed

SPARE_SECONDS = 0.05
"""Kept back from the budget for the end of the last part."""
GREEDY_SHARE = 0.1
"""Share of the budget within which the greedy planner improves its plan."""
LIGHT_SECONDS = 0.12
"""For the interpreted search: what it proves needs no library to be loaded."""
SMALL_BLOCKS = 12
"""Up to so many blocks the search over states comes before the precedence graph."""
SEARCH_SHARE = 0.6
"""Share of the remaining budget for the search over states before the layered model gets its turn."""
PRECEDENCE_SHARE = 0.3
"""Share of the remaining budget for the precedence graph where the other exact methods have a chance too."""
FEW_BLOCKS = 40
"""With more blocks than this the search over states and the layered model prove nothing more."""
LARGE_SHARE = 0.6
"""Share of the remaining budget for the precedence graph with more blocks: the beam gets the rest."""
FIRST_SHARE, FIRST_SECONDS = 0.1, 1.0
"""The least of both is for the first beam, and for more greedy passes, before the exact search: a better plan lets
that leave out more."""
WIDE_SEARCH_SHARE, LARGE_SEARCH_SHARE = 0.4, 0.2
"""The share of the search over states where a beam is likelier to help: more than `SMALL_BLOCKS`, `FEW_BLOCKS`."""
BEAM_SHARE = 0.7
"""Share of what the layered model leaves for the beam; the exact search has the rest, if it can use it."""
LAYERED_SHARE = 0.5
"""Share of the remaining budget for the layered model."""

Part = tuple[str, Callable[[], None]]
"""A part of the solve with its name."""


class SmashPlanner(BasePlanner):
    """The best anytime answer and the best proof that the package can give, its parts combined."""

    summary: ClassVar[str] = "the default: greedy, precedence graph, searches over states and layered model combined"
    proves: ClassVar[bool] = True
    aggregating: ClassVar[frozenset[str]] = frozenset(FAMILY)
    weighs: ClassVar[bool] = True
    budget_dependent: ClassVar[bool] = True  # its parts get shares of the budget

    def solve(
        self,
        instance: Instance,
        options: SolveOptions,
        budget: float,
        on_incumbent: OnIncumbent | None = None,
    ) -> PlanResult:
        """Plan for at most `budget` seconds of wall time; ends as soon as the best plan is proven optimal."""
        log = IncumbentLog(instance, options, on_incumbent, gentle=True)
        if not is_plain(instance, options):
            return self._family(instance, options, budget, log)
        impossible = log.without_plan()
        if impossible is not None:
            return impossible
        return _Combined(instance, options, budget, log).run()

    @staticmethod
    def _family(instance: Instance, options: SolveOptions, budget: float, log: IncumbentLog) -> PlanResult:
        """Plan with what is still exact: the precedence graph and its kin count actions of pick, place and topple.

        The search over the law's states comes first, the layered model gets what it leaves.
        """
        from smash.planners.astar.law_solve import offer_twin, search_family

        began = perf_counter()
        deadline = began + budget - min(SPARE_SECONDS, budget / 10)
        details: dict[str, Any] = {"exact_methods": ["search over states", "layered model"]}
        offer_twin(instance, options, log, began + GREEDY_SHARE * budget)
        half = perf_counter() + SEARCH_SHARE * (deadline - perf_counter())
        if search_family(instance, options, log, half, details):
            return log.result(infeasible=True, bound_origin="astar", details=details)
        if not log.proven and len(instance.blocks) <= FEW_BLOCKS:
            from smash.planners.layered import LayeredPlanner

            left = deadline - perf_counter()
            answer = LayeredPlanner().solve(instance, options, left, Relay(log, "milp"))
            if answer.status == "infeasible":
                return log.result(infeasible=True, bound_origin=answer.bound_origin, details=details)
        return log.result(details=details)


class _Combined:
    """One solve: the parts share the plans and the bounds of `log`."""

    def __init__(self, instance: Instance, options: SolveOptions, budget: float, log: IncumbentLog) -> None:
        self.instance = instance
        self.options = options
        self.log = log
        self.budget = budget
        self.deadline = perf_counter() + budget - min(SPARE_SECONDS, budget / 10)
        self.problem = Indexed.of(instance)
        self.log.prove(0, "start")
        self.seconds: dict[str, float] = {}

    def run(self) -> PlanResult:
        """Run the parts in turn until the best plan is proven or the budget is spent."""
        self._greedy()
        search = StateSearch(self.problem, self.options, self._cost(), on_bound=lambda b: self.log.prove(b, "astar"))
        beam = BeamSearch(self.problem, self.options, self._cost(), self.options.seed)
        for name, part in self._parts(search, beam):
            if self.log.proven or self._left() <= 0:
                break
            started = perf_counter()
            part()
            self.seconds[name] = perf_counter() - started
        details: dict[str, Any] = {
            "expanded": search.expanded,
            "search": search.ended,
            "beam": beam.ended,
            "beam_width": beam.width,
            "seconds": self.seconds,
        }
        return self.log.result(details=details)

    def _parts(self, search: StateSearch, beam: BeamSearch) -> tuple[Part, ...]:
        """Return the parts in their order, which depends on the size."""
        light = ("light search", lambda: self._search(search, perf_counter() + LIGHT_SECONDS, may_compile=False))
        precedence = ("precedence", self._precedence)
        passes = ("greedy passes", self._greedy_passes)
        first_beam = ("first beam", lambda: self._beam(beam, min(FIRST_SECONDS, FIRST_SHARE * self._left())))
        exact = ("search", lambda: self._search(search, perf_counter() + self._search_share() * self._left()))
        small = self.problem.blocks <= SMALL_BLOCKS
        return (
            light,
            *((exact, precedence) if small else (precedence, passes, first_beam, exact)),
            ("layered", self._layered),
            ("beam", lambda: self._beam(beam, (BEAM_SHARE if search.ended is None else 1.0) * self._left())),
            ("search to the end", lambda: self._search(search, self.deadline)),
            ("beam to the end", lambda: self._beam(beam, self._left())),
        )

    def _cost(self) -> int:
        assert self.log.cost is not None
        return self.log.cost

    def _left(self) -> float:
        return self.deadline - perf_counter()

    def _greedy(self) -> None:
        until = perf_counter() + GREEDY_SHARE * self.budget
        for steps in greedy_steps(self.problem, self.options, until, self.options.seed):
            self.log.offer(self.problem.actions(steps), "greedy")

    def _greedy_passes(self) -> None:
        """Give the greedy planner some more passes: cheap, and what helps most where locations are few."""
        until = perf_counter() + min(FIRST_SECONDS, FIRST_SHARE * self._left())
        for steps in greedy_steps(self.problem, self.options, until, self.options.seed, patient=True):
            self.log.offer(self.problem.actions(steps), "greedy")

    def _search_share(self) -> float:
        if self.problem.blocks <= SMALL_BLOCKS:
            return SEARCH_SHARE
        return WIDE_SEARCH_SHARE if self.problem.blocks <= FEW_BLOCKS else LARGE_SEARCH_SHARE

    def _search(self, search: StateSearch, until: float, may_compile: bool = True) -> None:
        """Search over states until `until` [s, clock of `perf_counter`]."""
        until = min(until, self.deadline)
        search.raise_bound(self.log.bound or 0, self._cost())
        while search.ended is None and perf_counter() < until:
            steps = search.run(until, may_compile)
            if steps is not None:
                self.log.offer(self.problem.actions(steps), "exact")
            if self.log.proven or steps is None:
                return

    def _beam(self, beam: BeamSearch, seconds: float) -> None:
        """Search with beams for so many seconds; where no state was left out, the best plan is optimal."""
        until = min(perf_counter() + seconds, self.deadline)
        beam.lower_upper(self._cost())
        while (steps := beam.run(until)) is not None:
            self.log.offer(self.problem.actions(steps), "beam")
            if self.log.proven:
                return
        if beam.ended == "proven":
            self.log.prove(min(beam.upper, self._cost()), "beam")

    def _precedence(self) -> None:
        from smash.planners.precedence.bound import ORIGIN, precedence_bound

        precedence_bound(
            self.instance,
            self.options,
            perf_counter() + (PRECEDENCE_SHARE if self.problem.blocks <= FEW_BLOCKS else LARGE_SHARE) * self._left(),
            lambda actions: self.log.offer(actions, "exact"),
            self.options.threads,
            on_bound=lambda bound: self.log.prove(bound, ORIGIN),
        )

    def _layered(self) -> None:
        if self.problem.blocks > FEW_BLOCKS:
            return
        from smash.planners.layered import LayeredPlanner

        LayeredPlanner().solve(self.instance, self.options, LAYERED_SHARE * self._left(), Relay(self.log, "milp"))
