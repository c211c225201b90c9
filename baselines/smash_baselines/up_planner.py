"""Any engine of unified-planning as a planner of the testbed."""

from __future__ import annotations

import sys
from typing import ClassVar

from smash.problem.extras import install_line, is_there
from smash_baselines.encodings import COMPOSED
from smash_baselines.engines.command import CommandEngine
from smash_baselines.engines.command_line import DOMAIN, PLAN, PROBLEM, CommandLine


class UpEngine(CommandEngine):
    """An engine of unified-planning on one encoding, in a process of its own: at most `feasible`."""

    summary: ClassVar[str] = "an engine of unified-planning"

    def __init__(self, engine: str, encoding: str) -> None:
        """Make the planner.

        Args:
            engine: the engine's name in the library's factory.
            encoding: what it is handed.
        """
        worker = (sys.executable, "-W", "ignore", "-m", "smash_baselines.engines.up_worker")
        super().__init__(CommandLine((*worker, engine, DOMAIN, PROBLEM, PLAN)), encoding)
        self.name = f"up:{engine}"

    def missing(self) -> str | None:
        """Return what is not installed, or None."""
        return None if is_there("unified_planning") else install_line("unified_planning")


def planner_of_up_engine(engine: str, encoding: str = COMPOSED) -> UpEngine:
    """Return an engine of unified-planning as a planner, as every other one has it: limits, incumbents, the law.

    Its anytime mode is used where it has one. What it says of optima is not taken for a proof.

    Example:
        `planner_of_up_engine("fast-downward").solve(instance, SolveOptions(), 10.0)`

    Args:
        engine: its name in `get_environment().factory.engines`.
        encoding: `chain`, `conditional`, or `pick-and-place` for engines that know no costs (plans without topple).
    """
    return UpEngine(engine, encoding)
