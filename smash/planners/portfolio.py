"""`smash`, the default planner: greedy, the exact methods, beams and neighbourhoods under one budget."""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter
from typing import ClassVar

from smash.planners.astar import BeamSearch, StateSearch, search_law_states
from smash.planners.greedy import GreedyRun, end_of
from smash.planners.neighbourhood import NeighbourhoodSearch
from smash.planners.neighbourhood.course import steps_of
from smash.planners.protocol import (
    HIGHS,
    SOLVERS,
    Method,
    MethodPlanner,
    OnIncumbent,
    PlanResult,
    Relay,
    Settings,
    SolveLog,
    anything,
    left,
    not_plain,
    plain,
    plan_options,
    settings_of,
)
from smash.problem.actions.registry import FAMILY
from smash.problem.model import Action, Instance, OnGoal, PlanOptions
from smash.problem.problem import Problem

GREEDY_SHARE = 0.1
"""Share of the budget within which the greedy planner improves its plan with topple, where the precedence graph has a
better one soon; without it makes all of its passes first."""
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
MANY_BLOCKS, PASSES_SHARE = 250, 0.2
"""With more blocks a pass of the beam takes a minute: greedy passes get this share of the time left, and no beam comes
before the neighbourhoods."""
LARGE_SHARE = 0.6
"""Share of the remaining budget for the precedence graph with more blocks: the beam gets the rest."""
LEAST_SHARE = 0.1
"""What the precedence graph gets in any case, where greedy passes are left that take long."""
FITTING_SHARE = 0.5
"""The same where its choices always are a plan, not all of the passes would end, and there is time for a proof."""
PROOF_SECONDS = 1e-3
"""What a proof with topple takes, per block: 1 to 8 s from 1,000 to 10,000 blocks."""
FIRST_SHARE, FIRST_SECONDS = 0.1, 1.0
"""The least of both is for the first beam, and for more greedy passes, before the exact search: a better plan lets
that leave out more."""
WIDE_SEARCH_SHARE, LARGE_SEARCH_SHARE = 0.4, 0.2
"""The share of the search over states where a beam is likelier to help: more than `SMALL_BLOCKS`, `FEW_BLOCKS`."""
BEAM_SHARE, LARGE_BEAM_SHARE = 0.5, 0.2
"""Share of what neighbourhoods leave for the beam; the second with more than `MANY_BLOCKS`."""
AGAIN_SHARE = 0.5
"""Share of what the beam leaves for the exact search, if it can use it; neighbourhoods have the rest."""
FIRST_NEIGHBOURHOODS, NEIGHBOURHOODS_SHARE = 0.15, 0.5
"""Share of the time left for neighbourhoods of the best plan, before the exact search and before the last beams."""
LAYERED_SHARE = 0.5
"""Share of the remaining budget for the layered model, where more comes after it."""


class SmashPlanner(MethodPlanner):
    """The best anytime answer and the best proof that the package can give, its parts combined.

    Costs, and actions beyond pick, place and topple, are left to what is still exact there: the search over the law's
    states, and the layered model with what that leaves.
    """

    summary: ClassVar[str] = "the default: greedy, precedence graph, searches over states and layered model combined"
    proves: ClassVar[bool] = True
    aggregating: ClassVar[frozenset[str]] = frozenset(FAMILY)
    weighs: ClassVar[bool] = True
    open_goals: ClassVar[bool] = True
    budget_dependent: ClassVar[bool] = True  # its parts get shares of the budget
    gentle: ClassVar[bool] = True
    solvers: ClassVar[frozenset[str]] = frozenset(SOLVERS)
    indexed: ClassVar[bool] = True  # its layered model

    def solve(
        self, instance: Instance, options: PlanOptions, budget: float, on_incumbent: OnIncumbent | None = None
    ) -> PlanResult:
        """Plan an instance, as every planner does; spelt out here, where readers of the package begin."""
        problem = Problem(instance, plan_options(options))
        return PlanResult.of(self.plan(problem, settings_of(options), budget, on_incumbent))

    def load_solver(self, settings: Settings) -> None:
        """Load a solver that is named; HiGHS is loaded when its turn comes, for most problems need none."""
        if settings.solver != HIGHS:
            from smash.planners.milp.solvers import load_solver

            load_solver(settings)

    def methods(self, problem: Problem, settings: Settings) -> Sequence[Method]:
        """Return the parts in their order, which depends on the size."""
        part = _Parts(settings)
        blocks = len(problem.instance.blocks)
        wide_share = WIDE_SEARCH_SHARE if blocks <= FEW_BLOCKS else LARGE_SEARCH_SHARE
        precedence = Method("precedence", plain, part.precedence, part.precedence_share(problem))
        small = (Method("search", plain, part.search, SEARCH_SHARE), precedence)
        large: tuple[Method, ...] = (
            precedence,
            Method("greedy to its end", plain, part.greedy),
            Method("greedy passes", plain, part.greedy_passes, FIRST_SHARE, FIRST_SECONDS),
            Method("first beam", plain, part.beams, FIRST_SHARE, FIRST_SECONDS),
            Method("first neighbourhoods", plain, part.neighbourhoods, FIRST_NEIGHBOURHOODS),
            Method("search", plain, part.search, wide_share),
        )
        if blocks > MANY_BLOCKS:
            large = (*large[:2], Method("greedy passes", plain, part.greedy_passes, PASSES_SHARE))
        return (
            Method("greedy", anything, part.greedy, part.greedy_share(problem)),
            Method("light search", plain, part.light_search, most=LIGHT_SECONDS),
            *(small if blocks <= SMALL_BLOCKS else large),
            Method("the law's states", not_plain, search_law_states, SEARCH_SHARE),
            Method("layered", lambda problem: plain(problem) or modelled(problem), part.layered, LAYERED_SHARE),
            Method("layered to the end", lambda problem: not_plain(problem) or modelled(problem), part.layered),
            Method("neighbourhoods", plain, part.neighbourhoods, NEIGHBOURHOODS_SHARE),
            Method("beam", plain, part.beams, BEAM_SHARE if blocks <= MANY_BLOCKS else LARGE_BEAM_SHARE),
            Method("search again", plain, part.search, AGAIN_SHARE),
            Method("neighbourhoods to the end", plain, part.neighbourhoods),
            Method("greedy passes to the end", plain, part.greedy_passes),  # where nothing compiled runs
        )


def modelled(problem: Problem) -> str | None:
    """Take problems whose layered model can prove something."""
    if problem.open_rest is not None:
        return problem.open_rest
    return None if len(problem.instance.blocks) <= FEW_BLOCKS else f"more than {FEW_BLOCKS} blocks"


def always_fits(problem: Problem) -> bool:
    """Whether the choices of the precedence graph are a plan with any number of buffers (docs/theory.md, theorem 1)."""
    instance = problem.instance
    aside = any(instance.start.get(buffer) for buffer in instance.buffers)
    return problem.options.topple and not isinstance(instance.goal, OnGoal) and not aside


class _Parts:
    """The methods of one solve: searches and beams go on where their turn before ended."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self._search: StateSearch | None = None
        self._beam: BeamSearch | None = None
        self._greedy: GreedyRun | None = None
        self._neighbourhoods: NeighbourhoodSearch | None = None
        self._bettered: tuple[Action, ...] | None = None
        """The plan whose neighbourhoods are searched."""

    @staticmethod
    def greedy_share(problem: Problem) -> float:
        """Return the share of the budget within which the greedy planner makes its passes at the beginning."""
        return GREEDY_SHARE if problem.options.topple else 1.0

    def precedence_share(self, problem: Problem) -> float:
        """Return the share of the time left that the precedence graph may take."""
        return PRECEDENCE_SHARE if len(problem.instance.blocks) <= FEW_BLOCKS else LARGE_SHARE

    def greedy(self, problem: Problem, log: SolveLog, until: float) -> None:
        """Plan as the greedy planner alone does: with the time for it no plan is dearer than its."""
        self._greedy_on(problem, log, until, patient=False, first_until=end_of(until, self.greedy_share(problem)))

    def greedy_passes(self, problem: Problem, log: SolveLog, until: float) -> None:
        """Give the greedy planner some more passes: cheap, and what helps most where locations are few."""
        self._greedy_on(problem, log, until, patient=True, first_until=until)

    def _greedy_on(self, problem: Problem, log: SolveLog, until: float, *, patient: bool, first_until: float) -> None:
        if self._greedy is None:
            self._greedy = GreedyRun(problem, self.settings.seed)
        for actions in self._greedy.plans(until, patient=patient, first_until=first_until):
            log.offer(actions, "greedy")
            if log.proven:
                break

    def light_search(self, problem: Problem, log: SolveLog, until: float) -> None:
        """Search over states as far as that needs no compiled code."""
        self._search_on(problem, log, until, may_compile=False)

    def search(self, problem: Problem, log: SolveLog, until: float) -> None:
        """Search over states."""
        self._search_on(problem, log, until, may_compile=True)

    def _search_on(self, problem: Problem, log: SolveLog, until: float, *, may_compile: bool) -> None:
        cost = log.upper
        if cost is None:  # there was no time for a greedy plan
            return
        numbered = problem.numbered
        if self._search is None:
            self._search = StateSearch(numbered, problem.options, cost, on_bound=lambda b: log.prove(b, "astar"))
        search = self._search
        search.raise_bound(log.bound or 0, cost)
        while search.ended is None and left(until) > 0:
            steps = search.run(until, may_compile)
            if steps is not None:
                log.offer(numbered.actions(steps), "exact")
            if log.settled or steps is None:
                break
        log.details |= {"expanded": search.expanded, "search": search.ended}

    def beams(self, problem: Problem, log: SolveLog, until: float) -> None:
        """Search with beams; where no state was left out, the best plan is optimal."""
        cost = log.upper
        if cost is None:  # there was no time for a greedy plan
            return
        if self._beam is None:
            self._beam = BeamSearch(problem.numbered, problem.options, cost, self.settings.seed)
        beam = self._beam
        beam.patterns = self._search.patterns if self._search is not None else None
        beam.lower_upper(cost)
        while (steps := beam.run(until)) is not None:
            log.offer(problem.numbered.actions(steps), "beam")
            if log.settled:
                break
        if beam.ended == "proven":
            log.prove(min(beam.upper, cost if log.upper is None else log.upper), "beam")
        log.details |= {"beam": beam.ended, "beam_width": beam.width}

    def neighbourhoods(self, problem: Problem, log: SolveLog, until: float) -> None:
        """Plan parts of the best plan anew, as often as there is time."""
        if log.best is None:  # there was no time for a greedy plan
            return
        if self._neighbourhoods is None:
            self._neighbourhoods = NeighbourhoodSearch(problem, self.settings.seed)
        search = self._neighbourhoods
        while not log.settled:
            if self._bettered is not log.best:  # others have found a better one, or the law has refused this one
                search.take(steps_of(problem.numbered, log.best))
                self._bettered = log.best
            steps = search.run(until)
            if steps is None:
                break
            self._bettered = log.best if log.offer(problem.numbered.actions(steps), "lns") else None
        log.details["neighbourhoods"] = search.tried

    def precedence(self, problem: Problem, log: SolveLog, until: float) -> None:
        """Bound the cost by the precedence graph, and schedule its choices; greedy passes come first if none fits."""
        from smash.planners.precedence.bound import ORIGIN, precedence_bound

        end = end_of(until, self.precedence_share(problem))
        if self._greedy is not None:  # what greedy passes are left keep their time, if that is not nearly all
            began = perf_counter()
            rest = end - began
            passes = self._greedy.seconds_left()
            proof = FITTING_SHARE * rest > PROOF_SECONDS * len(problem.instance.blocks) and always_fits(problem)
            least = FITTING_SHARE if proof and passes > rest else LEAST_SHARE
            until = min(until, began + max(least * rest, rest - passes))
        precedence_bound(
            problem,
            until,
            lambda actions: log.offer(actions, "exact"),
            self.settings.threads,
            lambda: self.greedy(problem, log, end),
            lambda bound: log.prove(bound, ORIGIN),
        )

    def layered(self, problem: Problem, log: SolveLog, until: float) -> None:
        """Solve the layered model."""
        from smash.planners.layered import LayeredPlanner

        answer = LayeredPlanner().plan(problem, self.settings, left(until), Relay(log, "milp"))
        if answer.status == "infeasible":
            log.refute(answer.bound_origin or "layered")
