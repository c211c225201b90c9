"""`python -m smash.experiments.studies.benchmark`: first plans, proofs and solvers, side by side.

Prints the Markdown tables of the README's results: `layered` (first incumbent and proof on the committed sets),
`solvers` (HiGHS against Gurobi on the same arrays), `large` (proofs at hundreds of blocks), `overhead` (what a run
costs beside its planner). With `--out DIR` each is written to DIR/NAME.md too.
"""

from __future__ import annotations

import argparse
import random
import statistics
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from time import perf_counter

from smash.experiments.studies.overhead import overhead_rows
from smash.planners.protocol import Settings, ask
from smash.planners.registry import get_planner
from smash.problem.errors import SmashError
from smash.problem.files.documents import write_text
from smash.problem.model import PlanOptions
from smash.problem.plan import Plan
from smash.problem.problem import Problem
from smash.problem.sets.open_instances import Shape, draw_instance
from smash.problem.sets.suites import PAPER_SUITES, read_suite

BUDGET = 60.0
LARGE = ((1000, 50, True), (100, 10, False), (200, 20, False), (200, 20, True))
"""Blocks, stacks, topple; as many buffers as blocks."""
SEEDS = (1, 2, 3)

COLD = Settings()


def timed(planner: str, problem: Problem, settings: Settings = COLD) -> tuple[Plan, float]:
    """Solve once; return the result and the wall time [s]."""
    chosen = get_planner(planner)
    started = perf_counter()
    result = ask(chosen, problem, settings, BUDGET)
    return result, perf_counter() - started


def spread(seconds: Sequence[float]) -> str:
    """Return median / worst."""
    return f"{statistics.median(seconds):.3f} / {max(seconds):.3f}" if seconds else "-"


def layered_rows() -> Iterator[str]:
    """Yield the table of `smash-layered` on the committed sets, cold and started from a greedy plan."""
    yield "| set | variant | first, cold | proof, cold | first, warm | proof, warm | proven |"
    yield "|---|---|---|---|---|---|---|"
    for suite in sorted(PAPER_SUITES):
        for topple in (True, False):
            times, proven = [], []
            for warm in (None, "greedy"):
                results = [
                    timed("smash-layered", Problem(instance, PlanOptions(topple)), Settings(warm_start=warm))
                    for instance in read_suite(suite)
                ]
                proof = [seconds for result, seconds in results if result.status == "optimal"]
                times.append(spread([result.incumbents[0].seconds for result, _ in results if result.incumbents]))
                times.append(spread(proof))
                proven.append(str(len(proof)))
            variant = "topple" if topple else "no topple"
            yield f"| {suite} | {variant} | {' | '.join(times)} | {', '.join(proven)} of {len(results)} |"


def solver_rows() -> Iterator[str]:
    """Yield the table of HiGHS against Gurobi on the layered relaxation, the models that both take."""
    from smash.planners.layered.blocks import MovingBlocks
    from smash.planners.layered.events import build_layered
    from smash.planners.layered.horizons import sound_layers
    from smash.planners.milp.solvers import gurobi, highs

    yield "| set | variant | models | HiGHS [s] | Gurobi [s] | ratio (median) |\n|---|---|---|---|---|---|"
    for suite in sorted(PAPER_SUITES):
        for topple in (True, False):
            pairs = []
            for instance in read_suite(suite)[:10]:
                problem = Problem(instance, PlanOptions(topple))
                blocks = MovingBlocks.of(problem)
                model = build_layered(problem, blocks, sound_layers(blocks)).milp
                theirs = gurobi.solve(model, time_limit=BUDGET)
                pairs.append((highs.solve(model, time_limit=BUDGET).seconds, theirs.seconds))
            ours, others = zip(*pairs, strict=True)
            ratio = statistics.median(a / b for a, b in pairs)
            variant = "topple" if topple else "no topple"
            yield f"| {suite} | {variant} | {len(pairs)} | {spread(ours)} | {spread(others)} | {ratio:.1f} |"


def large_rows() -> Iterator[str]:
    """Yield the table of proofs at hundreds of blocks."""
    yield "| planner | blocks | stacks | variant | seed | status | cost | bound | wall [s] |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for planner in ("precedence", "smash"):
        for blocks, stacks, topple in LARGE:
            for seed in SEEDS:
                instance = draw_instance(f"wide-{seed}", Shape(blocks, stacks, blocks), random.Random(seed))
                result, seconds = timed(planner, Problem(instance, PlanOptions(topple)))
                shape = f"{planner} | {blocks} | {stacks} | {'topple' if topple else 'no topple'} | {seed}"
                yield f"| {shape} | {result.status} | {result.cost} | {result.lower_bound} | {seconds:.2f} |"


TABLES = {"layered": layered_rows, "solvers": solver_rows, "large": large_rows, "overhead": overhead_rows}


def main() -> None:
    """Print the tables that are named on the command line, or all."""
    parser = argparse.ArgumentParser(prog="python -m smash.experiments.studies.benchmark", description=__doc__)
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"of {', '.join(TABLES)} (default: all)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="write each table to DIR/NAME.md too")
    arguments = parser.parse_args()
    names = arguments.tables or list(TABLES)
    unknown = [name for name in names if name not in TABLES]
    if unknown:
        sys.exit(f"benchmark: no table is called {unknown[0]!r}; known: {', '.join(TABLES)}")
    for planner in ("smash-layered", "precedence", "smash"):
        prepare = getattr(get_planner(planner), "prepare", None)
        if prepare is not None:
            prepare()
    try:
        for name in names:
            _make(name, arguments.out)
    except SmashError as error:
        sys.exit(f"benchmark: {error}")


def _make(name: str, out: Path | None) -> None:
    rows = []
    for row in TABLES[name]():
        print(row, flush=True)
        rows.append(row)
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        write_text(out / f"{name}.md", "\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
