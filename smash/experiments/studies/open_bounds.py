"""`python -m smash.experiments.studies.open_bounds`: what a planner proves today of the open problems of the list.

Prints a Markdown table: of each open problem the listed cost and bound, and what the planner finds and proves in a
budget of wall time. The list itself is not changed (`smash best-known update` does that, from records).
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from time import process_time

from smash.experiments.best_known.files import LIST, goal_kind, read_best_known
from smash.experiments.best_known.standing import Entry, open_instances, options_of
from smash.planners.protocol import Settings, ask
from smash.planners.registry import get_planner
from smash.problem.problem import Problem


def open_entries(goal: str, part: str) -> list[Entry]:
    """Return the entries of the list without a proof, of a kind of goal and with `part` in the instance's name."""
    instances = open_instances()
    entries = [entry for entry in read_best_known(LIST).sorted() if not entry.proven and part in entry.instance]
    return [entry for entry in entries if goal in ("", goal_kind(instances[entry.instance]))]


def rows(entries: list[Entry], planner: str, budget: float) -> Iterator[str]:
    """Yield the table, a row as soon as it is there, and a line that counts.

    Args:
        entries: problems of the list.
        planner: its name.
        budget: seconds of wall time each.
    """
    heads = ("instance", "variant", "listed cost", "listed bound", "cost", "bound", "by", "CPU [s]")
    yield f"| {' | '.join(heads)} |\n{'|---' * len(heads)}|"
    closed = better = 0
    chosen = get_planner(planner)
    for entry in entries:
        problem = Problem(open_instances()[entry.instance], options_of(entry.variant))
        worked = process_time()
        plan = ask(chosen, problem, Settings(), budget)
        bound = plan.lower_bound or 0
        costs = [cost for cost in (plan.cost, entry.cost) if cost is not None]
        closed += bound >= min(costs)
        better += bound > (entry.lower_bound or 0)
        known = f"{entry.instance} | {entry.variant} | {entry.cost} | {entry.lower_bound}"
        yield f"| {known} | {plan.cost} | {bound} | {plan.bound_origin} | {process_time() - worked:.1f} |"
    yield f"\n{closed} of {len(entries)} closed, {better} bounds better than listed"


def main() -> None:
    """Print the table of the open problems that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m smash.experiments.studies.open_bounds", description=__doc__)
    parser.add_argument("--goal", default="", metavar="KIND", help="stacks, positions or on (default: all)")
    parser.add_argument("--instance", default="", metavar="PART", help="part of the instance's name (default: all)")
    parser.add_argument("--planner", default="precedence", metavar="NAME", help="default: precedence")
    parser.add_argument("--budget", type=float, default=10.0, metavar="SECONDS", help="each (default: 10)")
    asked = parser.parse_args()
    for row in rows(open_entries(asked.goal, asked.instance), asked.planner, asked.budget):
        print(row, flush=True)


if __name__ == "__main__":
    main()
