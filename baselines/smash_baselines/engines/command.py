"""Any PDDL planner outside, by its command line: a program of which nothing is known but that it writes plans.

It is handed the domain and the problem, and works in a folder of its own. Its plans are judged by the law like all
others; whatever else it says proves nothing.
"""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

from smash.planners.protocol import OnIncumbent, ProblemPlanner, Settings
from smash.problem.errors import IllegalAction, SmashError, Unsupported
from smash.problem.plan import Plan, Status
from smash.problem.problem import Problem
from smash_baselines.encodings import COMPOSED, NO_COSTS, action_names, get_encoding, unsupported_reason
from smash_baselines.engine import EnginePlanner, Run
from smash_baselines.engines.command_line import DOMAIN, PLAN, PROBLEM, CommandLine
from smash_baselines.engines.outcomes import BUDGET_SPENT, EXITS, MEMORY_SPENT, Outcome
from smash_baselines.engines.plan_text import plans_in, steps_in
from smash_baselines.engines.process import EngineProcess
from smash_baselines.names import Step
from smash_baselines.parts.registry import TOLD
from smash_baselines.steps import actions_of

NAME = "command"
PLAN_FILE = "plan"
SELF_NAMED = ("{problem}.soln", "sas_plan")
"""The plan files of programs that are not told where to write, in the order in which they are looked for."""
UNLIMITED = sys.maxsize
"""The memory of a run is watched by its guardian, whose limit is the run's own [bytes]."""


class CommandPlanner(ProblemPlanner):
    """The planner `command`: runs the program of `Settings.command` on the encoding of `Settings.encoding`."""

    summary: ClassVar[str] = "any PDDL planner outside, by `--command 'PLANNER {domain} {problem} {plan}'`"
    aggregating: ClassVar[frozenset[str]] = TOLD
    weighs: ClassVar[bool] = True
    open_goals: ClassVar[bool] = True
    holds: ClassVar[bool] = True

    def refuses(self, problem: Problem, settings: Settings) -> str | None:
        """Return why the encoding cannot say the problem, or None.

        Raises:
            SmashError: where the command line is malformed, or no encoding is called so.
            Unsupported: where the program is not there.
        """
        missing = _line(settings).missing()
        if missing is not None:
            raise Unsupported(f"planner {NAME!r} is not installed: {missing}")
        return CommandEngine(_line(settings), _encoding(settings)).refuses(problem, settings)

    def plan(
        self, problem: Problem, settings: Settings, budget: float, on_incumbent: OnIncumbent | None = None
    ) -> Plan:
        """Run the program for at most `budget` seconds; the answer is at most `feasible`.

        Args:
            problem: what to plan.
            settings: with the command line.
            budget: seconds of wall time.
            on_incumbent: called with every better plan.
        """
        engine = CommandEngine(_line(settings), _encoding(settings), echoes=True)
        return engine.plan(problem, settings, budget, on_incumbent)


def check_command(command: str, encoding: str | None) -> None:
    """Refuse a command line or an encoding that is none.

    Raises:
        SmashError: with one line that says what is wrong.
    """
    CommandLine.parse(command)
    if encoding is not None:
        get_encoding(encoding)


def program_missing(command: str) -> str | None:
    """Return that the program of a command line is not there, or None."""
    return CommandLine.parse(command).missing()


def _line(settings: Settings) -> CommandLine:
    if settings.command is None:
        raise SmashError("the planner `command` needs a program: --command 'PLANNER {domain} {problem} {plan}'")
    return CommandLine.parse(settings.command)


def _encoding(settings: Settings) -> str:
    return settings.encoding or COMPOSED


class CommandEngine(EnginePlanner):
    """One program on one encoding; its answer is at most `feasible`.

    On the encoding that knows no topple it plans without, also where plans may topple.
    """

    name = NAME

    def __init__(self, line: CommandLine, encoding: str, *, echoes: bool = False) -> None:
        """Make the engine.

        Args:
            line: the program.
            encoding: what it is handed.
            echoes: whether its last lines are printed on standard error, which a run keeps for its record.
        """
        super().__init__(UNLIMITED)
        self._echoes = echoes
        self._command_line = line
        self.encoding = encoding

    def refuses(self, problem: Problem, settings: Settings) -> str | None:
        """Return why the encoding cannot say the problem, or None."""
        return unsupported_reason(self._asked(problem), self.encoding)

    def plan(
        self, problem: Problem, settings: Settings, budget: float, on_incumbent: OnIncumbent | None = None
    ) -> Plan:
        """Run the program for at most `budget` seconds.

        Args:
            problem: what to plan.
            settings: nothing of them means anything to it.
            budget: seconds of wall time.
            on_incumbent: called with every better plan.
        """
        answer = super().plan(self._asked(problem), settings, budget, on_incumbent)
        status: Status = "feasible" if answer.status == "optimal" else answer.status
        return replace(answer, status=status, lower_bound=None, bound_origin=None, options=problem.options)

    def _asked(self, problem: Problem) -> Problem:
        """Return what the program is asked: in the encoding that knows no topple, a problem without."""
        if self.encoding != NO_COSTS or not problem.options.topple or not problem.plain:
            return problem
        return Problem(problem.instance, replace(problem.options, topple=False, max_topple=None))

    def run(self, run: Run) -> Outcome:
        """Run the program and take its plans as they come."""
        domain, problem = run.task.write(run.directory)
        plan = run.directory / PLAN_FILE
        command = self._command_line.filled({DOMAIN: domain, PROBLEM: problem, PLAN: plan})
        names = (
            [PLAN_FILE]
            if self._command_line.writes_plan
            else [name.format(problem=problem.name) for name in SELF_NAMED]
        )
        plans = _Plans(run, names)
        with EngineProcess(
            command,
            directory=run.directory,
            deadline=run.deadline,
            memory=run.memory,
            limit_address_space=False,
        ) as program:
            try:
                if self._command_line.writes_plan:
                    for _ in program.lines(plans.look):
                        continue
                else:
                    for steps in plans_in(program.lines(plans.look), plans.actions):
                        plans.printed(steps)
                code = program.returncode()
            finally:
                if self._echoes and program.tail:
                    print("\n".join(program.tail), file=sys.stderr, flush=True)
        plans.end()
        return _ended(run, program, code)


def _ended(run: Run, program: EngineProcess, code: int | None) -> Outcome:
    if program.out_of_memory:
        return MEMORY_SPENT
    if code is None:
        return BUDGET_SPENT
    run.details["exit_code"] = code
    if run.log.best is not None:
        return Outcome("solved", "solved")
    run.details["last_words"] = next((line.strip() for line in reversed(program.tail) if line.strip()), "")
    if code == 0:
        return Outcome("exhausted", "the program ended without a plan (no proof)")
    known = EXITS.get(code)
    if known is not None and known.kind in ("unsolvable", "exhausted", "budget"):
        return Outcome("exhausted", f"the program ended without a plan, exit code {code} (no proof)")
    return Outcome("crashed", f"the program ended with exit code {code} without a plan")


class _Plans:
    """The plans that a program leaves in files and prints; a file that is still being written is looked at again.

    Attributes:
        actions: the names of the domain's actions.
    """

    def __init__(self, run: Run, names: list[str]) -> None:
        self._run = run
        self._names = names
        self._seen: dict[Path, tuple[int, int]] = {}
        self._doubts: dict[Path, str] = {}
        self._printed: list[str] = []
        self._unread: list[Step] = []
        self.actions = action_names(run.task.domain_text)

    def look(self) -> None:
        """Take the plans of new and of changed files."""
        for file in self._files():
            with_stat = file.stat()
            state = (with_stat.st_mtime_ns, with_stat.st_size)
            if self._seen.get(file) == state:
                continue
            self._seen[file] = state
            text = file.read_text(encoding="utf-8", errors="replace")
            written = self._run.log.elapsed - max(0.0, time.time() - with_stat.st_mtime)
            steps = steps_in(text, self.actions)
            doubt = self._take(steps, max(0.0, written)) if steps else _no_step(text)
            self._doubts.pop(file, None)
            if doubt is not None:
                self._doubts[file] = f"{file.name}: {doubt}"

    def printed(self, steps: list[Step]) -> None:
        """Take a plan that was printed; where the program writes files, only if there is none in them."""
        self.look()
        if self._seen:
            self._unread = steps
            return
        doubt = self._take(steps, None)
        if doubt is not None:
            self._printed.append(doubt)

    def end(self) -> None:
        """Look once more; where there is no plan at all, what was wrong with the last one is kept."""
        self.look()
        if self._unread and self._run.log.best is None:
            self._take(self._unread, None)
        doubts = list(self._doubts.values())
        self._run.log.refusals += doubts or ([] if self._run.log.best is not None else self._printed[-1:])

    def _files(self) -> Iterator[Path]:
        """Yield the files of the first name that has some, numbered ones in their order."""
        for name in self._names:
            form = re.compile(re.escape(name) + r"(?:\.(\d+))?")
            numbered = [(form.fullmatch(file.name), file) for file in self._run.directory.iterdir() if file.is_file()]
            files = sorted((int(match[1] or 0), file) for match, file in numbered if match)
            if files:
                yield from (file for _, file in files)
                return

    def _take(self, steps: list[Step], seconds: float | None) -> str | None:
        """Offer a plan that the law accepts; return what is wrong with any other."""
        run = self._run
        try:
            actions = actions_of(steps, run.task)
        except IllegalAction as error:
            return str(error)
        verdict = run.log.problem.law.check(actions)
        if not verdict.accepted:
            return str(verdict)
        run.log.offer(actions, run.origin, seconds)
        return None


def _no_step(text: str) -> str | None:
    """Return what stands in a file without a step in place of a plan; None where nothing does."""
    first = next((line.strip() for line in text.splitlines() if line.split(";", 1)[0].strip()), None)
    return None if first is None else f"no line says a step of the domain: {first[:60]!r} is the first"
