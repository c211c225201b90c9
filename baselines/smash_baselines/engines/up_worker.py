"""Any engine of unified-planning as a program, `python -m smash_baselines.engines.up_worker`.

Its arguments are the engine's name, the files of domain and problem, and what plan files are to be called. It writes
each plan as it comes, to `PLAN.1`, `PLAN.2` and so on, one `(action arg …)` a line; whatever it starts dies with it.
"""

from __future__ import annotations

import functools
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from smash_baselines.engines.process import dies_with_parent
from smash_baselines.up_problem import sequential_plan, steps_of_up_plan

if TYPE_CHECKING:
    from unified_planning.model import Problem


def main(engine: str, domain: str, problem: str, plan: str) -> None:
    """Plan until the engine ends.

    Args:
        engine: its name in the library's factory.
        domain: the PDDL domain's file.
        problem: the PDDL problem's file.
        plan: what the plan files are called, before their numbers.
    """
    # Wrappers start servers that only garbage collection ends; a worker that is killed must not leave them behind.
    subprocess.Popen = functools.partial(subprocess.Popen, preexec_fn=dies_with_parent())  # type: ignore[assignment,misc]
    from unified_planning.io import PDDLReader
    from unified_planning.shortcuts import get_environment

    get_environment().credits_stream = None
    asked = PDDLReader().parse_problem(domain, problem)
    number = 0
    for result in _results(engine, asked):
        if result.plan is not None:
            number += 1
            steps = steps_of_up_plan(sequential_plan(result.plan, asked))
            _write(Path(f"{plan}.{number}"), "".join(f"({' '.join(step)})\n" for step in steps))
        print(result.status.name, *(message.message for message in result.log_messages or []), flush=True)


def _results(engine: str, problem: Problem) -> Iterator[Any]:
    from unified_planning.shortcuts import AnytimePlanner, OneshotPlanner, get_environment

    anytime = get_environment().factory.engine(engine).is_anytime_planner()
    if anytime:
        with AnytimePlanner(name=engine) as planner:
            yield from planner.get_solutions(problem)
    else:
        with OneshotPlanner(name=engine) as planner:
            yield planner.solve(problem)


def _write(file: Path, text: str) -> None:
    """Write a file that is whole from the moment it is there."""
    part = file.with_name(f".{file.name}")
    part.write_text(text, encoding="utf-8")
    os.replace(part, file)


if __name__ == "__main__":
    main(*sys.argv[1:])
