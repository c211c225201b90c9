"""Aries through unified-planning, in a child process: an unsupported input kills its server."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from time import monotonic
from typing import Any, ClassVar

from smash.problem.extras import install_line, is_there
from smash_baselines.engine import EnginePlanner, Run
from smash_baselines.engines.outcomes import BUDGET_SPENT, MEMORY_SPENT, Outcome
from smash_baselines.engines.process import EngineProcess

_ENDS = {
    "SOLVED_SATISFICING": Outcome("solved", "solved"),
    "SOLVED_OPTIMALLY": Outcome("solved", "solved"),
    "INTERMEDIATE": Outcome("solved", "solved"),
    "TIMEOUT": BUDGET_SPENT,
    "MEMOUT": MEMORY_SPENT,
    "UNSOLVABLE_PROVEN": Outcome("exhausted", "given up without a plan (no proof)"),
    "UNSOLVABLE_INCOMPLETELY": Outcome("exhausted", "given up without a plan (no proof)"),
    "UNSUPPORTED_PROBLEM": Outcome("unsupported", "the engine does not support the problem"),
}


class AriesPlanner(EnginePlanner):
    """Aries in its anytime mode. It optimises within a bounded number of actions only, so it proves nothing here.

    It takes no costs that are functions (unified-planning reads them as real numbers), which the family's domains have.
    """

    aggregating: ClassVar[frozenset[str]] = frozenset({"topple"})
    weighs: ClassVar[bool] = False

    def missing(self) -> str | None:
        """Return what is not installed, or None."""
        there = all(is_there(package) for package in ("unified_planning", "up_aries", "grpc"))
        return None if there else install_line("up_aries")

    def takes_conditional_effects(self) -> bool:
        """Return whether it takes encodings with conditional effects: its server stops at them."""
        return False

    def run(self, run: Run) -> Outcome:
        """Run the worker and take its plans as they come."""
        run.task.write(run.directory)
        seconds = run.deadline - monotonic()
        end: Outcome | None = None
        with EngineProcess(
            [sys.executable, "-W", "ignore", "-m", "smash_baselines.engines.aries_worker", f"{seconds:.3f}"],
            directory=run.directory,
            deadline=run.deadline,
            memory=run.memory,
            limit_address_space=False,
            environment={"PYTHONPATH": os.pathsep.join([str(Path(__file__).resolve().parents[2]), *sys.path[1:]])},
        ) as engine:
            for line in engine.lines():
                words = _words(line)
                if "read" in words:
                    run.details["translation_seconds"] = round(run.log.elapsed - run.details["compile_seconds"], 4)
                if "plan" in words:
                    run.offer(tuple(step) for step in words["plan"])
                if "end" in words:
                    end = _ENDS.get(words["end"], Outcome("crashed", f"ended with {words['end']}"))
            code = engine.returncode()
        if engine.out_of_memory:
            return MEMORY_SPENT
        if engine.timed_out:
            return BUDGET_SPENT
        if end is None:
            run.details["last_words"] = next((line.strip() for line in reversed(engine.tail) if line.strip()), "")
            return Outcome("crashed", f"the worker ended with exit code {code}")
        return end


def _words(line: str) -> dict[str, Any]:
    try:
        words = json.loads(line)
    except ValueError:  # a warning of a library
        return {}
    return words if isinstance(words, dict) else {}
