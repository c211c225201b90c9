"""What planners with a MILP share: the solver behind its arrays is chosen, and one that takes none of them is said."""

from __future__ import annotations

from typing import ClassVar

from smash.planners.milp.solvers import load_solver
from smash.planners.milp.tested import TESTED
from smash.planners.protocol import SOLVERS, MethodPlanner, OnIncumbent, Settings
from smash.planners.protocol.tested import why_doubted
from smash.problem.errors import Unsupported
from smash.problem.plan import Plan
from smash.problem.problem import Problem


class MilpPlanner(MethodPlanner):
    """A planner that solves MILPs among other things."""

    solvers: ClassVar[frozenset[str]] = frozenset(SOLVERS)
    indexed: ClassVar[bool] = True

    def load_solver(self, settings: Settings) -> None:
        """Load the solver.

        Raises:
            MissingExtra: where it is not installed.
        """
        load_solver(settings)

    def why_doubted(self, problem: Problem, settings: Settings) -> str | None:
        """Doubt what a solver concludes beyond the sums of costs that it was tested with."""
        return why_doubted(settings.solver, problem.instance, TESTED.get(settings.solver, 0))

    def plan(
        self, problem: Problem, settings: Settings, budget: float, on_incumbent: OnIncumbent | None = None
    ) -> Plan:
        """Plan for at most `budget` seconds of wall time.

        Args:
            problem: what to plan.
            settings: how to solve it.
            budget: seconds of wall time.
            on_incumbent: called with every better plan, its `bound` with every better bound.

        Raises:
            Unsupported: where nothing was found because the solver takes none of the models.
        """
        answer = super().plan(problem, settings, budget, on_incumbent)
        stages = answer.details.get("stages", ())
        refused = [stage["refused"] for stage in stages if "refused" in stage]
        if answer.status == "unknown" and refused and len(refused) == len(stages):
            raise Unsupported(refused[0])
        return answer
