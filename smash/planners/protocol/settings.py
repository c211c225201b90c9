"""How a planner solves, apart from what a plan may use: the settings of solvers and searches."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from smash.problem.model import PlanOptions

HIGHS = "highs"
"""The solver of a MILP where none is named."""
SOLVERS = (HIGHS, "cpsat", "scip", "gurobi")
"""The solvers that a planner with a MILP may be told to use."""
ACTIONS, SECONDS = "actions", "seconds"
OBJECTIVES = (ACTIONS, SECONDS)
"""What a plan may be chosen for: the fewest actions, or the least expected seconds of its execution."""
MOST_THREADS = 256
"""Threads that a solver may be given; with some thousands it does nothing but start them."""


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of one solve; each planner uses those that mean something to it.

    Attributes:
        warm_start: the planner whose plan starts a model (None: cold).
        horizon: number of time steps or layers of the time-indexed models, in place of their own choice.
        threads: most threads of a solver.
        seed: for whatever draws at random.
        command: the command line of a program outside, for the planner `command`.
        encoding: the PDDL encoding that such a program is handed (None: the planner's choice).
        solver: solves the MILPs, one of `SOLVERS`.
        objective: what a plan is chosen for, one of `OBJECTIVES`; planners count actions, whoever asks them weighs.
        robust: whether plans of equal cost are told apart by their risk.
    """

    warm_start: str | None = None
    horizon: int | None = None
    threads: int = 1
    seed: int = 0
    command: str | None = None
    encoding: str | None = None
    solver: str = HIGHS
    objective: str = ACTIONS
    robust: bool = False

    @property
    def cold(self) -> Settings:
        """The same for a planner that starts another one's model: no warm start, no horizon, no command."""
        return replace(self.counting, warm_start=None, horizon=None, command=None, encoding=None)

    @property
    def counting(self) -> Settings:
        """The same for a planner that is to count actions and nothing else."""
        return replace(self, objective=ACTIONS, robust=False)


@dataclass(frozen=True, slots=True)
class SolveOptions(PlanOptions):
    """Plan options and settings in one, as `Planner.solve` takes them."""

    warm_start: str | None = None
    horizon: int | None = None
    threads: int = 1
    seed: int = 0
    command: str | None = None
    encoding: str | None = None
    solver: str = HIGHS
    objective: str = ACTIONS
    robust: bool = False

    @classmethod
    def of(cls, options: PlanOptions, settings: Settings) -> SolveOptions:
        """Return both in one."""
        chosen = {field.name: getattr(settings, field.name) for field in fields(settings)}
        return cls(options.topple, options.max_topple, without=options.without, **chosen)


def plan_options(options: PlanOptions) -> PlanOptions:
    """Return the plan options alone, whatever settings come with them."""
    return PlanOptions(options.topple, options.max_topple, without=options.without)


def settings_of(options: PlanOptions) -> Settings:
    """Return the settings that come with plan options; the defaults where none do."""
    if not isinstance(options, SolveOptions):
        return Settings()
    return Settings(**{field.name: getattr(options, field.name) for field in fields(Settings)})
