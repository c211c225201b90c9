"""Planners of the Fast Downward family: the bundled translator, then the bundled search, as two processes.

The driver script is left out: it would be one more process between us and the search, and it counts CPU seconds
where a budget is wall time. Plans are read the moment the search says that it has written one.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from time import monotonic
from typing import Any, ClassVar

from smash.problem.extras import install_line
from smash_baselines.engine import EnginePlanner, Run
from smash_baselines.engines.configurations import Configuration
from smash_baselines.engines.outcomes import BUDGET_SPENT, MEMORY_SPENT, Outcome, outcome_of
from smash_baselines.engines.process import EngineProcess
from smash_baselines.steps import parse_step

PLAN_FILE = "plan"
_PLAN_WRITTEN = "Plan cost:"
_PLAN_COST = re.compile(r"^; cost = (\d+)", re.MULTILINE)
_ASTAR_BOUND = re.compile(r"\] f = (\d+)")
_SYMK_BOUND = re.compile(r"\] BOUND: (\d+) < (\d+)")
_SIZES = re.compile(r"^Translator (variables|facts|operators|task size): (\d+)")
_SEARCH_CLOCK = re.compile(r"^\[t=([\d.]+)s")
_EXHAUSTED = "Completely explored state space"
_INFINITE = 2**31 - 1
"""SymK's lower bound when a frontier is empty: nothing is left to expand."""


class DownwardPlanner(EnginePlanner):
    """Fast Downward or SymK with one search configuration on one encoding."""

    configuration: ClassVar[Configuration]

    def missing(self) -> str | None:
        """Return what is not installed, or None."""
        engine = self.configuration.engine
        return None if engine.root is not None else install_line(engine.package)

    def takes_conditional_effects(self) -> bool:
        """Return whether its search does."""
        return self.configuration.conditional_effects

    def run(self, run: Run) -> Outcome:
        """Translate, then search."""
        domain, problem = run.task.write(run.directory)
        outcome = self._translate(run, domain, problem)
        run.details["translation_seconds"] = round(run.log.elapsed - run.details["compile_seconds"], 4)
        if outcome.kind == "solved":
            started = run.log.elapsed
            outcome = self._search(run)
            run.details["search_seconds"] = round(run.log.elapsed - started, 4)
        if outcome.kind == "unsolvable":
            run.infeasible = True
        return outcome

    def _translate(self, run: Run, domain: Path, problem: Path) -> Outcome:
        engine = self.configuration.engine
        command = [sys.executable, "-m", engine.translator, domain.name, problem.name, "--sas-file", "task.sas"]
        with EngineProcess(
            command,
            directory=run.directory,
            deadline=run.deadline,
            memory=run.memory,
            environment={"PYTHONPATH": str(engine.root), "PYTHONHASHSEED": "0"},
        ) as translator:
            for line in translator.lines():
                size = _SIZES.match(line)
                if size:
                    run.details[f"translator_{size[1].replace(' ', '_')}"] = int(size[2])
            return _ended(run, translator)

    def _search(self, run: Run) -> Outcome:
        root = self.configuration.engine.root
        arguments = self.configuration.arguments(run.deadline - monotonic())
        command = [f"{root}/downward", *arguments, "--internal-plan-file", PLAN_FILE]
        exhausted = False
        plans = _PlanFiles(run)
        with EngineProcess(
            command,
            directory=run.directory,
            deadline=run.deadline,
            memory=run.memory,
            stdin=run.directory / "task.sas",
        ) as search:
            for line in search.lines():
                if _PLAN_WRITTEN in line:
                    plans.read_new(line)
                bound = bound_in(line) if self.configuration.admissible else None
                exhausted = exhausted or _EXHAUSTED in line or bound == _INFINITE
                if bound is not None and bound != _INFINITE:
                    run.raise_bound(bound)
            outcome = _ended(run, search)
        plans.read_new("")
        return self._judge(run, outcome, exhausted)

    def _judge(self, run: Run, outcome: Outcome, exhausted: bool) -> Outcome:
        """Draw the conclusions that only an admissible configuration allows."""
        if not self.configuration.admissible:
            # An inadmissible search may prune what its heuristic takes for a dead end: no proof.
            return Outcome("exhausted", outcome.text) if outcome.kind == "unsolvable" else outcome
        if outcome.kind == "solved" and outcome.text == "solved" and run.log.cost is not None:
            self._raise_to_cost(run)
        if outcome.kind == "exhausted" and exhausted and run.log.best is None:
            return Outcome("unsolvable", "search space exhausted: there is no plan")
        return outcome

    def _raise_to_cost(self, run: Run) -> None:
        """Take the cost of the search's last plan as proven, if the law charges the same."""
        costs = run.details["search_costs"]
        if costs and costs[-1] != run.log.cost:
            run.log.refusals.append(f"{self.name}: the search says cost {costs[-1]}, the law {run.log.cost}")
        elif run.log.cost is not None:
            run.raise_bound(run.log.cost)


class _PlanFiles:
    """The plan files `plan`, `plan.1`, `plan.2`, … of one search."""

    def __init__(self, run: Run) -> None:
        self._run = run
        self._read: set[Path] = set()
        self._times: list[Any] = run.details.setdefault("search_clock", [])
        self._costs: list[int] = run.details.setdefault("search_costs", [])

    def read_new(self, line: str) -> None:
        """Offer every plan file that was not there before; `line` is what the search said, with its own clock."""
        for file in sorted(self._run.directory.glob(f"{PLAN_FILE}*"), key=_plan_number):
            if file in self._read:
                continue
            self._read.add(file)
            text = file.read_text(encoding="utf-8")
            self._run.offer(parse_step(step) for step in text.splitlines() if step.startswith("("))
            cost = _PLAN_COST.search(text)
            if cost:
                self._costs.append(int(cost[1]))
            clock = _SEARCH_CLOCK.match(line)
            if clock:
                self._times.append(float(clock[1]))


def bound_in(line: str) -> int | None:
    """Return the lower bound that a line of an admissible search tells, or None.

    SymK's two numbers are the cost that any further plan has at least and the cost of its best plan; once it is
    done, the first is above the second.
    """
    bounds = _ASTAR_BOUND.search(line) or _SYMK_BOUND.search(line)
    return min(map(int, bounds.groups())) if bounds else None


def _plan_number(file: Path) -> int:
    suffix = file.name.removeprefix(PLAN_FILE).lstrip(".")
    return int(suffix) if suffix.isdigit() else 0


def _ended(run: Run, process: EngineProcess) -> Outcome:
    code = process.returncode()
    if process.out_of_memory:
        return MEMORY_SPENT
    if code is None or ((process.timed_out or monotonic() >= run.deadline) and code < 0):
        return BUDGET_SPENT
    outcome = outcome_of(code)
    if outcome.kind == "crashed":
        run.details["last_words"] = next((line.strip() for line in reversed(process.tail) if line.strip()), "")
    return outcome
