"""`python -m smash.experiments.studies.engine_ranges`: up to which costs engines and solvers prove what is true.

Draws small problems with costs of growing size, solves each by this package's own search over states (`astar`, whole
numbers without a limit) and by each engine, and prints a Markdown table of who agreed. `wrong` is a proven cost that is
not the optimum, or a proof that there is no plan. `TESTED` of `smash_baselines.engines.tested` and of
`smash.planners.milp.tested` hold what came out.
"""

from __future__ import annotations

import argparse
import random
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace

from smash.planners.protocol import HIGHS, SOLVERS, Settings, ask
from smash.planners.protocol.tested import most_sum
from smash.planners.registry import get_planner
from smash.problem.costs import Costs
from smash.problem.errors import SmashError, Unsupported
from smash.problem.model import Instance, PlanOptions
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate

SOLVED = tuple(f"{planner}/{solver}" for planner in ("smash-layered", "smash-flow") for solver in SOLVERS)
"""Planners with a solver of theirs behind a slash."""
ENGINES = ("fd-opt", "fd-opt-ipdb", "symk-opt", "cp-sat", "clingo", "didp", *SOLVED)
SIZES = (1, 1_000, 1_000_000, 20_000_000, 70_000_000)
"""The dearest action; the last is the most that engines take with four blocks."""


def drawn(size: int, seed: int) -> Instance:
    """Return a small problem whose actions cost whole numbers from a tenth of `size` to `size`."""
    draw = random.Random(f"{size} {seed}")
    (instance,) = generate("multi", blocks=4, stacks=3, buffers=1, count=1, seed=seed)
    actions = {name: draw.randint(max(1, size // 10), size) for name in ("pick", "place", "topple")}
    return replace(instance, costs=Costs(actions=actions))


def answers(engine: str, problems: Sequence[Problem], budget: float) -> Counter[str]:
    """Return how often an engine agreed with `astar`, said nothing, refused, or was wrong."""
    name, _, solver = engine.partition("/")
    found: Counter[str] = Counter()
    for problem in problems:
        right = ask(get_planner("astar"), problem, Settings(), budget)
        assert right.status == "optimal", right
        try:
            plan = ask(get_planner(name), problem, Settings(solver=solver or HIGHS), budget)
        except Unsupported:
            found["refused"] += 1
            continue
        except SmashError:
            found["nothing"] += 1
            continue
        claimed = plan.details.get("claimed", {})
        bound = max(claimed.get("lower_bound", 0), plan.lower_bound or 0)
        if "infeasible" in (plan.status, claimed.get("status")) or bound > (right.cost or 0):
            found["wrong"] += 1
        else:
            found["agreed" if bound == plan.cost == right.cost else "nothing"] += 1
    return found


def rows(engines: Sequence[str], count: int, budget: float) -> Iterator[str]:
    """Yield the table, a row an engine and size of costs.

    Args:
        engines: planners by name, perhaps with a solver behind a slash.
        count: problems a size, each with and without topple.
        budget: seconds of wall time each.
    """
    yield "| engine | dearest action | sums up to | problems | agreed | wrong | no proof | refused |"
    yield "|---|---|---|---|---|---|---|---|"
    for engine in engines:
        for size in SIZES:
            instances = [drawn(size, seed) for seed in range(count)]
            problems = [Problem(instance, PlanOptions(topple)) for instance in instances for topple in (True, False)]
            most = max(map(most_sum, instances))
            found = answers(engine, problems, budget)
            shown = " | ".join(str(found[word]) for word in ("agreed", "wrong", "nothing", "refused"))
            yield f"| `{engine}` | {size:,} | {most:,.0f} | {len(problems)} | {shown} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--engine", action="append", metavar="NAME", help="Or NAME/SOLVER; repeatable (default: those that prove)."
    )
    parser.add_argument("--count", type=int, default=5, metavar="K", help="Problems a size.")
    parser.add_argument("--budget", type=float, default=20.0, metavar="S", help="Wall time of each.")
    given = parser.parse_args()
    for line in rows(given.engine or ENGINES, given.count, given.budget):
        print(line, flush=True)


if __name__ == "__main__":
    main()
