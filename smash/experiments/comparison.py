"""`compare`: planners on the same instances, a table with one row a run. `smash compare` is the same with files."""

from __future__ import annotations

import os
import warnings
from collections.abc import Collection, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event
from typing import TYPE_CHECKING

from smash.experiments.sweeps.experiment import Experiment, PlannerEntry, Run, check_experiment, experiment_runs
from smash.experiments.sweeps.sweep import local_task, sweep
from smash.problem.arguments import text
from smash.problem.errors import SmashError
from smash.problem.extras import TABLES, require
from smash.problem.files.given import GivenInstance, given_instance
from smash.problem.files.instances import write_instance
from smash.problem.model import Instance
from smash.problem.sets.suites import read_suite
from smash.records.believing import believed_runs
from smash.records.files import RUNS
from smash.records.runs import RunRecord
from smash.records.writing import Writer

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = (
    *("instance", "planner", "variant", "status", "cost", "lower_bound", "optimum", "gap", "first_seconds"),
    *("best_seconds", "wall_seconds", "memory_mib", "solved", "proven", "outcome", "reason"),
)
"""The columns of `compare`, in their order."""


def compare(
    instances: GivenInstance | Iterable[GivenInstance],
    planners: str | Iterable[str],
    *,
    budget: float = 30.0,
    variants: str | Sequence[str] = ("topple",),
) -> pd.DataFrame:
    """Run every planner on every instance, each run in processes of its own, and return one row a run.

    Example:
        `smash.compare(smash.suite("multi-4")[:5], ["smash", "greedy"], budget=2)`

    Args:
        instances: the instances, or paths of their files; a name or a path alone is a set, as in `suite`.
        planners: names from `planner_names()`.
        budget: wall time of each run [s].
        variants: what plans may use: `topple`, `no-topple`, `max-topple-3` and the like; one or several.

    Returns:
        A table with the columns `instance`, `planner`, `variant`; `status`, `cost` and `lower_bound` as in a plan;
        `optimum` (where some planner proved it) and `gap` (cost over it, as a share); `first_seconds` and
        `best_seconds` (when the first and the best plan were found), `wall_seconds` and `memory_mib` (what the run
        took); `solved`, `proven`, `outcome` and `reason` (how it ended).

    A planner with a claim that another's plan shows to be false proves nothing there, which a warning says.

    Raises:
        MissingExtra: where the extra `analysis` is not installed.
        SmashError: where there is nothing to run, or an argument is wrong; a planner that fails is a row that says so.
    """
    require("compare", *TABLES)
    from smash_analysis.comparison import compared
    from smash_analysis.metrics import metric_names

    chosen = _chosen(instances)
    names = [text("planners", name) for name in ((planners,) if isinstance(planners, str) else planners)]
    variants = (variants,) if isinstance(variants, str) else variants
    with TemporaryDirectory(prefix="smash-compare-") as folder:
        suite, out = Path(folder) / "instances", Path(folder) / "results"
        suite.mkdir()
        for number, instance in enumerate(chosen):
            write_instance(instance, suite / f"{number:06}.json")
        experiment = comparison_of([str(suite)], names, budget=budget, variants=variants)
        runs = experiment_runs(experiment)
        _do(runs, out)
        found = believed_runs(out, {run.key for run in runs})
        table = compared(found.records)
    for line in found.lines():
        warnings.warn(line, stacklevel=2)
    return table.reindex(columns=[*COLUMNS, *metric_names(table)]).assign(planner=table["label"])


def comparison_of(
    suites: Sequence[str],
    planners: Iterable[str],
    *,
    programs: Mapping[str, str] | None = None,
    encoding: str | None = None,
    budget: float,
    variants: Sequence[str],
    buffers: Sequence[int] = (),
    instances: int | None = None,
    seed: int = 0,
    memory: int | None = None,
    jobs: int = 1,
) -> Experiment:
    """Return the experiment that compares planners on sets.

    Args:
        suites: names or directories of sets.
        planners: names of planners.
        programs: command lines of programs outside, by the names that they are to have.
        encoding: the PDDL encoding that the programs are handed (None: the chain).
        budget: wall time of each run [s].
        variants: what plans may use.
        buffers: buffer counts (none: as filed).
        instances: only the first so many of each set.
        seed: for planners that draw.
        memory: limit over a run's processes [MiB] (None: as everywhere).
        jobs: runs at a time.

    Raises:
        SmashError: where a setting cannot be run.
    """
    experiment = Experiment(
        name="compare",
        suites=list(suites),
        planners=[
            *(PlannerEntry(planner) for planner in planners),
            *(PlannerEntry(name, command=line, encoding=encoding) for name, line in (programs or {}).items()),
        ],
        budgets=[budget],
        buffers=list(buffers) or None,
        instances=instances,
        variants=list(variants),
        seeds=[seed],
        jobs=jobs,
        **({} if memory is None else {"memory": memory}),
    )
    check_experiment(experiment, "compare")
    return experiment


def _chosen(instances: GivenInstance | Iterable[GivenInstance]) -> Sequence[Instance]:
    """Return the instances that are meant, each name once."""
    if isinstance(instances, str | os.PathLike):
        return read_suite(instances)
    given = instances if isinstance(instances, Iterable) else [instances]
    chosen = [given_instance(instance) for instance in given]
    if not chosen:
        raise SmashError("compare: no instance is given; at least one is needed")
    names = [instance.name for instance in chosen]
    for name in names:
        if names.count(name) > 1:
            raise SmashError(f"compare: two instances are called {name!r}; give one of them another name")
    return chosen


class _Silent:
    """Shows nothing."""

    def begun(self, run: Run) -> None:
        """A run has started."""

    def ended(self, run: Run, record: RunRecord) -> None:
        """A run has ended and is recorded."""


def _do(runs: Collection[Run], out: Path) -> None:
    """Do the runs one after the other and record them in `out`."""
    stop, silent = Event(), _Silent()
    with Writer(out, RUNS) as records, ThreadPoolExecutor(1) as executor:
        sweep(runs, records, executor, local_task(stop, silent), silent, stop)
