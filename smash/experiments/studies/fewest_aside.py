"""`python -m smash.experiments.studies.fewest_aside`: proofs without topple, with as many buffers as blocks.

Prints a Markdown table of the planner `precedence` on random instances: cost, bound, gap, wall and CPU seconds, and
what proved the bound. With `--topple` no block has to be put aside and the fewest topples are what is hard. With
`--twice` each is bounded a second time by the other prover, from nothing the first one found.
"""

from __future__ import annotations

import argparse
import random
import statistics
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter, process_time

from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.hitting_set import HIGHS, MAXSAT, HittingSetSolver
from smash.planners.protocol import Settings, ask
from smash.planners.registry import get_planner
from smash.problem.files.documents import write_text
from smash.problem.model import Instance, PlanOptions
from smash.problem.problem import Problem
from smash.problem.sets.open_instances import Shape, draw_instance


def drawn(blocks: int, stacks: int, number: int, topple: bool) -> Instance:
    """Return instance `number` of a size, with a buffer for each block, none where topples do without."""
    name = f"aside-{blocks}-{stacks}-{number}"
    return draw_instance(name, Shape(blocks, stacks, 0 if topple else blocks), random.Random(name))


def second_bound(problem: Problem, prover: str, budget: float) -> str:
    """Return the cell of a second proof: the prover's bound, and its CPU seconds.

    Args:
        problem: what is bounded.
        prover: of the hitting set's.
        budget: seconds of wall time.
    """
    worked = process_time()
    graph = build_graph(problem)
    found = HittingSetSolver(graph, prover=prover).solve(perf_counter() + budget)
    return f"{graph.base_cost + found.bound} ({prover}, {process_time() - worked:.1f} s)"


def rows(
    blocks: int, stacks: int, numbers: range, topple: bool, budget: float, *, twice: bool = False
) -> Iterator[str]:
    """Yield the table: a row an instance as soon as it is solved, then medians.

    Args:
        blocks: of each instance.
        stacks: of each instance.
        numbers: of the instances.
        topple: whether topple is allowed.
        budget: seconds of wall time each.
        twice: whether each is bounded by the other prover as well, in as much time.
    """
    yield (
        "| instance | status | cost | bound | gap [%] | wall [s] | CPU [s] | prover | second bound |\n"
        "|---|---|---|---|---|---|---|---|---|"
    )
    planner = get_planner("precedence")
    seconds, proven = [], 0
    for number in numbers:
        instance = drawn(blocks, stacks, number, topple)
        began, worked = perf_counter(), process_time()
        problem = Problem(instance, PlanOptions(topple))
        plan = ask(planner, problem, Settings(), budget)
        wall, cpu = perf_counter() - began, process_time() - worked
        seconds.append((wall, cpu))
        proven += plan.status == "optimal"
        assert plan.cost is not None
        gap = 100.0 * (plan.cost - (plan.lower_bound or 0)) / max(1, plan.cost)
        figures = f"{plan.cost} | {plan.lower_bound} | {gap:.2f} | {wall:.1f} | {cpu:.1f}"
        prover = plan.details["prover"] or "-"
        again = second_bound(problem, HIGHS if prover == MAXSAT else MAXSAT, budget) if twice else ""
        yield f"| {instance.name} | {plan.status} | {figures} | {prover} | {again} |"
    walls, cpus = zip(*seconds, strict=True)
    middle = f"{statistics.median(walls):.1f} | {statistics.median(cpus):.1f}"
    yield f"| median | {proven} of {len(numbers)} proven | | | | {middle} | | |"


def main() -> None:
    """Print the table of the size that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m smash.experiments.studies.fewest_aside", description=__doc__)
    parser.add_argument("--blocks", type=int, default=300, metavar="N", help="of each instance (default: 300)")
    parser.add_argument("--stacks", type=int, default=30, metavar="N", help="of each instance (default: 30)")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="number of the first instance (default: 0)")
    parser.add_argument("--count", type=int, default=10, metavar="N", help="how many instances (default: 10)")
    parser.add_argument("--topple", action="store_true", help="allow topple, without buffers")
    parser.add_argument("--twice", action="store_true", help="bound each a second time, by the other prover")
    parser.add_argument("--budget", type=float, default=90.0, metavar="SECONDS", help="each (default: 90)")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write the table to FILE too")
    asked = parser.parse_args()
    prepare = getattr(get_planner("precedence"), "prepare", None)
    if prepare is not None:
        prepare()
    lines = []
    numbers = range(asked.first, asked.first + asked.count)
    for row in rows(asked.blocks, asked.stacks, numbers, asked.topple, asked.budget, twice=asked.twice):
        print(row, flush=True)
        lines.append(row)
    if asked.out is not None:
        write_text(asked.out, "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
