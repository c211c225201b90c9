"""ENHSP, a Java planner, called directly: unified-planning would neither bound its memory nor show its plans early."""

from __future__ import annotations

import re
import shutil
from importlib.util import find_spec
from pathlib import Path
from typing import ClassVar

from smash.problem.extras import install_line
from smash_baselines.engine import EnginePlanner, Run
from smash_baselines.engines.outcomes import BUDGET_SPENT, MEMORY_SPENT, Outcome
from smash_baselines.engines.process import EngineProcess
from smash_baselines.names import Step
from smash_baselines.steps import parse_step

_STEP = re.compile(r"^[\d.]+: (\(.*\))$")
_PLAN_BEGINS = "Found Plan:"
_PLAN_ENDS = "Plan-Length:"
_NO_MEMORY = "OutOfMemoryError"
_GIVES_UP = ("Unsolvable", "unsolvable")
_HEAP_SHARE = 0.75
"""Of the memory limit; the rest is for the Java machine itself."""


class EnhspPlanner(EnginePlanner):
    """ENHSP in its anytime mode, greedy best-first search with the additive heuristic (its wrapper's default).

    It never proves: a greedy search that gives up has not shown that there is no plan, whatever it prints.
    """

    search: ClassVar[tuple[str, ...]] = ("-h", "hadd", "-s", "gbfs", "-anytime")

    def missing(self) -> str | None:
        """Return what is not installed, or None."""
        if _jar() is None:
            return install_line("up_enhsp")
        return None if shutil.which("java") else "it needs Java: no `java` on the PATH"

    def run(self, run: Run) -> Outcome:
        """Run the planner and read its plans from its output as they come."""
        domain, problem = run.task.write(run.directory)
        heap = max(16, int(run.memory * _HEAP_SHARE) >> 20)
        command = ["java", f"-Xmx{heap}m", "-XX:+UseSerialGC", "-jar", str(_jar())]
        command += ["-o", domain.name, "-f", problem.name, "-npm", *self.search]
        with EngineProcess(
            command,
            directory=run.directory,
            deadline=run.deadline,
            memory=run.memory,
            limit_address_space=False,
        ) as engine:
            words = _read(run, engine)
            code = engine.returncode()
        if engine.out_of_memory or _NO_MEMORY in words:
            return MEMORY_SPENT
        if code is None:
            return BUDGET_SPENT
        if run.log.best is not None:
            return Outcome("solved", "solved")
        if any(phrase in words for phrase in _GIVES_UP):
            return Outcome("exhausted", "search given up without a plan (no proof)")
        return Outcome("crashed", f"ended without a plan, exit code {code}")


def _read(run: Run, engine: EngineProcess) -> str:
    """Offer each plan when it is complete; return the lines outside of plans."""
    words: list[str] = []
    steps: list[Step] | None = None
    for line in engine.lines():
        step = _STEP.match(line)
        if line.startswith(_PLAN_BEGINS):
            steps = []
        elif steps is not None and step:
            steps.append(parse_step(step[1]))
        elif steps is not None and line.startswith(_PLAN_ENDS):
            run.offer(steps)
            steps = None
        else:
            words.append(line)
    run.details["last_words"] = next((word.strip() for word in reversed(words) if word.strip()), "")
    return "\n".join(words)


def _jar() -> Path | None:
    spec = find_spec("up_enhsp")
    if spec is None or not spec.submodule_search_locations:
        return None
    jar = Path(spec.submodule_search_locations[0]) / "ENHSP" / "enhsp.jar"
    return jar if jar.exists() else None
