"""`python -m smash.experiments.studies.beside_greedy`: `smash` beside `greedy` alone, in the same time.

Sixty stated problems of 50 to 2,000 blocks on few and many stacks, with few and many buffers, with and without topple;
each is planned by both, one right after the other, in each budget. Prints a Markdown table, and which of the plans of
`smash` are worse: none should be.
"""

from __future__ import annotations

import argparse
import random
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, process_time

from smash.planners.protocol import Settings, ask
from smash.planners.registry import get_planner
from smash.problem.files.documents import write_text
from smash.problem.model import PlanOptions
from smash.problem.plan import Plan
from smash.problem.problem import Problem
from smash.problem.sets.open_instances import Shape, draw_instance

BLOCKS = (50, 100, 200, 500, 1000, 2000)
FEW = 3
"""Buffers, and stacks are one more; many are as many buffers as blocks, and a stack for every ten."""


@dataclass(frozen=True, slots=True)
class Stated:
    """One of the problems."""

    blocks: int
    stacks: int
    buffers: int
    topple: bool
    number: int

    @property
    def name(self) -> str:
        """What it is called, which is also its seed."""
        return f"beside-{self.blocks}-{self.stacks}-{self.buffers}-{'topple' if self.topple else 'plain'}-{self.number}"

    def problem(self) -> Problem:
        """Draw it."""
        shape = Shape(self.blocks, self.stacks, self.buffers)
        return Problem(draw_instance(self.name, shape, random.Random(self.name)), PlanOptions(self.topple))


def stated() -> list[Stated]:
    """Return the sixty problems."""
    return [
        Stated(blocks, stacks, buffers, topple, number)
        for blocks in BLOCKS
        for stacks in (FEW + 1, blocks // 10)
        for buffers, topple, count in ((FEW, False, 2), (blocks, False, 2), (FEW, True, 1))
        for number in range(count)
    ]


def rows(problems: Iterable[Stated], budgets: Iterable[float]) -> Iterator[str]:
    """Yield the table, a row a problem and budget as soon as it is planned, then what is worse.

    Args:
        problems: what is planned.
        budgets: seconds of wall time of each plan.
    """
    yield (
        "| problem | budget [s] | greedy | smash | bound | first plan [s] | smash used [s] | CPU: greedy, smash [s] |\n"
        "|---|---|---|---|---|---|---|---|"
    )
    worse, count = [], 0
    for stated_problem in problems:
        for budget in budgets:
            alone, _, cpu_alone = _planned("greedy", stated_problem, budget)
            plan, used, cpu = _planned("smash", stated_problem, budget)
            first = f"{plan.incumbents[0].seconds:.2f}" if plan.incumbents else "none"
            costs = f"{_said(alone.cost)} | {_said(plan.cost)} | {plan.lower_bound}"
            yield (
                f"| {stated_problem.name} | {budget:g} | {costs} | {first} | {used:.1f} | {cpu_alone:.1f}, {cpu:.1f} |"
            )
            count += 1
            if alone.cost is not None and (plan.cost is None or plan.cost > alone.cost):
                worse.append(f"{stated_problem.name} in {budget:g} s: {_said(plan.cost)}, not {alone.cost}")
    yield f"\n{len(worse)} of {count} worse than greedy alone" + "".join(f"\n- {line}" for line in worse)


def _said(cost: int | None) -> str:
    return "none" if cost is None else str(cost)


def _planned(planner: str, stated_problem: Stated, budget: float) -> tuple[Plan, float, float]:
    """Return a plan with the seconds of wall time and of the processor that it took."""
    problem = stated_problem.problem()  # a fresh one: what is known of it is kept
    began, worked = perf_counter(), process_time()
    plan = ask(get_planner(planner), problem, Settings(), budget)
    return plan, perf_counter() - began, process_time() - worked


def main() -> None:
    """Print the table of the budgets that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m smash.experiments.studies.beside_greedy", description=__doc__)
    parser.add_argument("--budget", type=float, action="append", metavar="SECONDS", help="repeatable (default: 1, 10)")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="the first of the problems (default: 0)")
    parser.add_argument("--count", type=int, default=len(stated()), metavar="N", help="how many (default: all)")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write the table to FILE too")
    asked = parser.parse_args()
    for name in ("greedy", "smash"):
        prepare = getattr(get_planner(name), "prepare", None)
        if prepare is not None:
            prepare()
    lines = []
    for row in rows(stated()[asked.first : asked.first + asked.count], asked.budget or (1.0, 10.0)):
        print(row, flush=True)
        lines.append(row)
    if asked.out is not None:
        write_text(asked.out, "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
