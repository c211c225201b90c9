"""What a planner is: for outsiders one object with `solve`, for ours one that takes a `Problem`."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from typing import ClassVar, Protocol, runtime_checkable

from smash.planners.protocol.answer import OnIncumbent, PlanResult
from smash.planners.protocol.settings import HIGHS, Settings, SolveOptions, plan_options, settings_of
from smash.problem.model import Instance, PlanOptions
from smash.problem.plan import Plan
from smash.problem.problem import Problem


@runtime_checkable
class Planner(Protocol):
    """A planner. Third parties add one by the `smash.planners` entry-point group; only `solve` is required.

    A planner may also define, and the testbed then uses:

    - `summary: str`, one line for `smash planners`;
    - `unsupported(instance, options) -> str | None`, why it cannot take this problem, asked before it starts;
    - `anytime: bool`, whether it improves a first plan until the budget ends (its incumbents then stand for
      every smaller budget);
    - `budget_dependent: bool`, whether what it does in its first seconds depends on how many it is given (it
      shares its budget out among parts, say); it is then run at every budget by itself. Where the attribute is
      missing, a planner that is not `anytime` counts as dependent;
    - `prepare() -> None`, loads libraries and compiles what is compiled once, before the clock starts;
    - `proves: bool`, whether it can report `optimal`;
    - `aggregating: frozenset[str]`, the aggregating actions that it plans with (`topple` alone, where it says nothing);
    - `weighs: bool`, whether it takes instances whose actions do not all cost 1;
    - `open_goals: bool`, whether it takes `on` goals whose `ontable` and `clear` leave open where blocks come to rest;
    - `holds: bool`, whether it takes a start with a block in the hand;
    - `solvers: frozenset[str]`, the MILP solvers that it can be told to use: one that names none has no MILP that
      a solver could be chosen for or another planner's plan could start, and refuses to be told so;
    - `indexed: bool`, whether it has a model with an index of time, whose steps or layers can be told: one that says
      nothing refuses a horizon;
    - `load_solver(settings) -> None`, loads the solver that it is told to use, before the clock starts;
    - `missing() -> str | None`, what is not installed that it needs;
    - `with_encoding(name) -> Planner`, the same planner on another PDDL encoding (`NAME:ENCODING`);
    - `build_model(instance, options) -> Milp`, the MILP that `solve` starts with, for `smash model`.
    """

    def solve(
        self,
        instance: Instance,
        options: SolveOptions,
        budget: float,
        on_incumbent: OnIncumbent | None = None,
    ) -> PlanResult:
        """Plan for at most `budget` seconds of wall time."""
        ...


class BasePlanner:
    """Defaults for the optional parts of the protocol."""

    summary: ClassVar[str] = ""
    anytime: ClassVar[bool] = True
    proves: ClassVar[bool] = False
    budget_dependent: ClassVar[bool] = False
    aggregating: ClassVar[frozenset[str]] = frozenset({"topple"})
    weighs: ClassVar[bool] = False
    open_goals: ClassVar[bool] = False
    holds: ClassVar[bool] = False
    solvers: ClassVar[frozenset[str]] = frozenset()
    indexed: ClassVar[bool] = False

    def prepare(self) -> None:
        """Load what is loaded once and compile what is compiled once; not counted in the planner's time."""

    def unsupported(self, instance: Instance, options: SolveOptions) -> str | None:
        """Return why this planner cannot take the problem, or None."""
        return None

    def missing(self) -> str | None:
        """Return what is not installed that this planner needs, or None."""
        return None


class ProblemPlanner(BasePlanner, ABC):
    """A planner of this package: it plans a `Problem`, and keeps the protocol for those who call `solve`."""

    @abstractmethod
    def plan(
        self, problem: Problem, settings: Settings, budget: float, on_incumbent: OnIncumbent | None = None
    ) -> Plan:
        """Plan for at most `budget` seconds of wall time.

        Args:
            problem: what to plan; `why_refused` must have nothing against it.
            settings: how to solve it.
            budget: seconds of wall time.
            on_incumbent: called with every better plan, its `bound` with every better bound.
        """

    def refuses(self, problem: Problem, settings: Settings) -> str | None:
        """Return why this planner cannot take the problem, or None: what `unsupported` is to planners from outside."""
        return None

    def unsupported(self, instance: Instance, options: PlanOptions) -> str | None:
        """Return why this planner cannot take an instance, or None."""
        return self.refuses(Problem(instance, plan_options(options)), settings_of(options))

    def solve(
        self, instance: Instance, options: PlanOptions, budget: float, on_incumbent: OnIncumbent | None = None
    ) -> PlanResult:
        """Plan an instance: `plan` for those who know no `Problem`; options without settings get the defaults."""
        problem = Problem(instance, plan_options(options))
        return PlanResult.of(self.plan(problem, settings_of(options), budget, on_incumbent))


def why_refused(planner: Planner, problem: Problem, settings: Settings) -> str | None:
    """Return why a planner cannot take a problem, or None: asked before it starts.

    An action that it does not know, or costs that it does not weigh, would make its proofs wrong.

    Args:
        planner: ours, or any object with `solve`.
        problem: what it would plan.
        settings: how it would solve it.
    """
    known = getattr(planner, "aggregating", BasePlanner.aggregating)
    instance = problem.instance
    for kind in problem.kinds:
        if kind.name not in known:
            return f"it does not plan with {kind.name} (`--without {kind.name}` leaves that out)"
    if any(carrier.holds for carrier in instance.carriers) and "carry" not in known:
        return "blocks start on a carrier"
    if not instance.costs.plain and not getattr(planner, "weighs", False):
        return f"it counts actions, and the instance's costs are in {instance.costs.unit}"
    if instance.hand is not None and not getattr(planner, "holds", False):
        return "the hand holds a block at the start"
    if problem.open_rest is not None and not getattr(planner, "open_goals", False):
        return problem.open_rest
    if (reason := why_not_settings(planner, settings)) is not None:
        return reason
    if isinstance(planner, ProblemPlanner):
        return planner.refuses(problem, settings)
    ask = getattr(planner, "unsupported", None)
    return None if ask is None else ask(problem.posed, SolveOptions.of(problem.options, settings))


def why_not_settings(planner: Planner, settings: Settings) -> str | None:
    """Return why a planner cannot solve so, or None: a setting that means nothing to it is not passed over in silence.

    Args:
        planner: ours, or any object with `solve`.
        settings: how it would solve.
    """
    solvers = getattr(planner, "solvers", BasePlanner.solvers)
    if settings.solver != HIGHS and settings.solver not in solvers:
        return f"it has no MILP that `--solver {settings.solver}` could solve"
    if settings.warm_start is not None and not solvers:
        return f"it has no MILP that `--warm-start {settings.warm_start}` could start"
    if settings.horizon is not None and not getattr(planner, "indexed", BasePlanner.indexed):
        return f"it has no model with an index of time that `--horizon {settings.horizon}` could be for"
    return None


def why_unsupported(planner: Planner, instance: Instance, options: PlanOptions) -> str | None:
    """Return why a planner cannot take an instance, or None: `why_refused` for those who know no `Problem`."""
    return why_refused(planner, Problem(instance, plan_options(options)), settings_of(options))


def ask(
    planner: Planner,
    problem: Problem,
    settings: Settings,
    budget: float,
    on_incumbent: OnIncumbent | None = None,
    *,
    name: str = "",
) -> Plan:
    """Have any planner plan a problem: ours take it as it is, those from outside as instance and options.

    Args:
        planner: ours, or any object with `solve`.
        problem: what to plan; `why_refused` must have nothing against it.
        settings: how to solve it.
        budget: seconds of wall time.
        on_incumbent: called with every better plan.
        name: what the planner is called.

    Returns:
        Its answer, as the planner gives it: the law has not judged it yet.

    Raises:
        TypeError: where a planner from outside answers with something else.
    """
    if isinstance(planner, ProblemPlanner):
        return replace(planner.plan(problem, settings, budget, on_incumbent), planner=name)
    options = SolveOptions.of(problem.options, settings)
    result = planner.solve(problem.posed, options, budget, on_incumbent)
    try:
        return PlanResult.as_plan(result, problem.instance, name, problem.options)
    except AttributeError as error:
        raise TypeError(f"solve returned no valid PlanResult: {error}") from None
