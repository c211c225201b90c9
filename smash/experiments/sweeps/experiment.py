"""An experiment: a short TOML file, checked whole before anything runs, and the list of runs that it means.

One anytime run at the largest budget stands for every smaller one, since its incumbents carry their times. A
planner that is `budget_dependent` (see `smash.planners.protocol`) is run at each budget by itself, and so is one whose
plans are weighed (`objective`, `robust`): its incumbents do not tell what less time would have led to. To check the
reading, `cutoff_sample` runs of each other planner are repeated with every smaller budget as the real limit.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TypeVar, cast

import msgspec
from smash_baselines.engines.command import check_command, program_missing

from smash.experiments.isolation.job import DEFAULT_MEMORY, Job
from smash.planners.protocol import ACTIONS, HIGHS, MOST_THREADS, OBJECTIVES, SOLVERS, Settings, SolveOptions
from smash.planners.registry import COMMAND, get_planner, why_unknown
from smash.problem.buffers import with_buffers
from smash.problem.errors import MalformedFile, SmashError, Unsupported
from smash.problem.files.documents import convert, parse_json, parse_toml, read_bytes
from smash.problem.model import Instance
from smash.problem.problem import Problem
from smash.problem.sets.suites import read_suite, suite_names
from smash.records.runs import RunKind, instance_hash
from smash.records.variants import FURTHER, variant_options

INSTANCES = "instances"
SETS = "sets.json"
"""`RESULTS/instances/sets.json`: set -> its folder beside the list, in a directory that holds its own experiment."""

_SINCE = {"command": None, "encoding": None, "solver": HIGHS, "objective": ACTIONS, "robust": False}
"""Settings that keys of earlier records do not know, and what they were: they are part of a key where they differ."""

T = TypeVar("T")
Expect = Callable[[bool, str, str], None]
"""`expect(holds, part, problem)` refuses the file where something does not hold."""


class PlannerEntry(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """One `[[planners]]` table: a planner with its settings; the grid's fields may be overridden for it alone.

    With a `command` the planner is that program, and the name is yours to choose.
    """

    name: str
    label: str | None = None
    warm_start: str | None = None
    horizon: int | None = None
    threads: int = 1
    command: str | None = None
    encoding: str | None = None
    solver: str = HIGHS
    objective: str = ACTIONS
    robust: bool = False
    suites: list[str] | None = None
    instances: int | None = None
    buffers: list[int] | None = None
    budgets: list[float] | None = None
    variants: list[str] | None = None
    cutoff_sample: int | None = None

    @property
    def planner(self) -> str:
        """The registered name of the planner."""
        return self.name if self.command is None else COMMAND

    def settings(self, seed: int = 0) -> Settings:
        """Return how it solves."""
        return Settings(
            *(self.warm_start, self.horizon, self.threads, seed, self.command, self.encoding, self.solver),
            objective=self.objective,
            robust=self.robust,
        )

    @property
    def shown(self) -> str:
        """Its label; where none is given its name, with what is not everybody's: solver, objective, robust."""
        apart = [self.solver] if self.solver != HIGHS else []
        apart += [self.objective] if self.objective != ACTIONS else []
        apart += ["robust"] if self.robust else []
        return self.label or (f"{self.name} ({', '.join(apart)})" if apart else self.name)


class Experiment(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """An experiment file. `instances` takes the first so many of each suite; without `buffers` they stay as filed.

    `budgets` are seconds, `memory` MiB over a run's processes, `variants` are `topple`, `no-topple` or
    `max-topple-M`, each perhaps followed by `-no-carry` and the like.
    """

    name: str
    suites: list[str]
    planners: list[PlannerEntry]
    budgets: list[float] = msgspec.field(default_factory=lambda: [30.0])
    buffers: list[int] | None = None
    instances: int | None = None
    variants: list[str] = msgspec.field(default_factory=lambda: ["topple", "no-topple"])
    seeds: list[int] = msgspec.field(default_factory=lambda: [0])
    memory: int = DEFAULT_MEMORY
    jobs: int = 1
    cutoff_sample: int = 0


@dataclass(frozen=True, slots=True)
class Run:
    """One run of an experiment. `key` names it for good: equal keys mean equal jobs."""

    key: str
    experiment: str
    label: str
    suite: str
    variant: str
    kind: RunKind
    budgets: tuple[float, ...]
    job: Job


def read_experiment(path: str | os.PathLike[str], *, to_run: bool = True) -> Experiment:
    """Read an experiment file; suites that are directories are found beside it.

    Args:
        path: of the file.
        to_run: whether its planners must be there; what was run elsewhere can be looked at without them.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    where = os.fspath(path)
    experiment = cast(Experiment, convert(parse_toml(read_bytes(path, "experiment files"), where), Experiment, where))
    check_experiment(experiment, where, to_run=to_run)
    return experiment


def check_experiment(experiment: Experiment, where: str = "experiment", *, to_run: bool = True) -> None:
    """Refuse settings that cannot be run.

    Args:
        experiment: the settings.
        where: what is named where they are refused.
        to_run: whether its planners must be there.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """

    def expect(holds: bool, part: str, problem: str) -> None:
        if not holds:
            raise MalformedFile(where, f"`{part}`: {problem}")

    plain = re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9._-]*", experiment.name) is not None
    expect(plain, "name", f"{experiment.name!r} is no plain file name (letters, digits, `.`, `_`, `-`)")
    expect(bool(experiment.planners), "planners", "empty; at least one is needed")
    expect(experiment.memory >= 1, "memory", f"{experiment.memory} is not allowed; MiB, 1 and more")
    expect(experiment.jobs >= 1, "jobs", f"{experiment.jobs} is not allowed; 1 and more")
    _expect_list(expect, "seeds", experiment.seeds, lambda seed: seed >= 0, "0 and more")
    _check_grid(expect, "", experiment)
    settings: dict[str, tuple[str, Settings]] = {}
    for index, entry in enumerate(experiment.planners):
        part = f"planners[{index}]"
        for name in filter(None, (entry.planner, entry.warm_start)):
            unknown = why_unknown(name) if to_run else None
            expect(unknown is None, part, unknown or "")
        _check_command(expect, part, entry)
        few = 1 <= entry.threads <= MOST_THREADS
        expect(few, f"{part}.threads", f"{entry.threads} is not allowed; 1 to {MOST_THREADS}")
        allowed = f"{entry.solver!r} is not allowed; {', '.join(SOLVERS)}"
        expect(entry.solver in SOLVERS, f"{part}.solver", allowed)
        allowed = f"{entry.objective!r} is not allowed; {', '.join(OBJECTIVES)}"
        expect(entry.objective in OBJECTIVES, f"{part}.objective", allowed)
        expect(entry.horizon is None or entry.horizon >= 1, f"{part}.horizon", f"{entry.horizon} is not allowed")
        _check_grid(expect, f"{part}.", entry)
        label, chosen = entry.shown, (entry.planner, entry.settings())
        expect(bool(label.strip()), f"{part}.label", "empty; a name for the pictures is needed")
        other = settings.setdefault(label, chosen)
        expect(other == chosen, f"{part}.label", f"{label!r} is also the label of other settings; give it another")


def _check_command(expect: Expect, part: str, entry: PlannerEntry) -> None:
    if entry.command is None:
        whole = entry.encoding is None
        expect(whole, f"{part}.encoding", "goes with a `command`; a planner on another encoding is `NAME:ENCODING`")
        return
    known = entry.name != COMMAND and why_unknown(entry.name) is None
    expect(not known, f"{part}.name", f"{entry.name!r} is a planner of its own; call the program otherwise")
    try:
        check_command(entry.command, entry.encoding)
    except SmashError as error:
        expect(False, f"{part}.command", str(error))


def _check_grid(expect: Expect, at: str, grid: Experiment | PlannerEntry) -> None:
    _expect_list(expect, f"{at}suites", grid.suites, lambda suite: suite != "", "a set's name or a directory")
    _expect_list(expect, f"{at}budgets", grid.budgets, lambda s: 0 < s <= 1e9, "seconds above 0")
    _expect_list(expect, f"{at}buffers", grid.buffers, lambda count: 0 <= count <= 10_000, "0 and more")
    further = ", ".join(f"`-no-{name}`" for name in FURTHER)
    allowed = f"`topple`, `no-topple` or `max-topple-M`, each perhaps followed by {further}"
    _expect_list(expect, f"{at}variants", grid.variants, lambda v: variant_options(v) is not None, allowed)
    few, sample = grid.instances, grid.cutoff_sample
    expect(few is None or few >= 1, f"{at}instances", f"{few} is not allowed; 1 and more")
    expect(sample is None or sample >= 0, f"{at}cutoff_sample", f"{sample} is not allowed; 0 and more")


def _expect_list(expect: Expect, part: str, values: list[T] | None, fits: Callable[[T], bool], allowed: str) -> None:
    if values is None:
        return
    expect(bool(values), part, "empty; at least one is needed")
    for value in values:
        expect(fits(value), part, f"{value!r} is not allowed; {allowed}")
        expect(values.count(value) == 1, part, f"{value!r} stands twice")


def experiment_runs(
    experiment: Experiment, base: Path = Path(), dependent: Callable[[str], bool] | None = None
) -> list[Run]:
    """Return every run of a checked experiment, instance by instance, so that a part of them is a fair sample.

    Args:
        experiment: the experiment.
        base: where suites that are directories are looked for.
        dependent: whether a planner is run at each budget by itself; None asks the planner.

    Raises:
        MalformedFile: where a suite or an instance is refused, a run stands twice.
    """
    runs: dict[str, tuple[int, Run]] = {}
    for entry in experiment.planners:
        planned = list(_entry_runs(experiment, entry, base, dependent or budget_dependent))
        sample = experiment.cutoff_sample if entry.cutoff_sample is None else entry.cutoff_sample
        anytime = sorted((run.key, index, run) for index, run in planned if run.kind == "anytime")
        planned += [(index, cut) for _, index, run in anytime[:sample] for cut in _cutoffs(run)]
        for index, run in planned:
            if run.key in runs:
                problem = f"{run.label!r} meets {run.job.instance.name!r} of {run.suite!r} twice with equal settings"
                raise MalformedFile(experiment.name, f"`planners`: {problem}")
            runs[run.key] = (index, run)
    return [run for _, run in sorted(runs.values(), key=lambda pair: pair[0])]


def _entry_runs(
    experiment: Experiment, entry: PlannerEntry, base: Path, dependent: Callable[[str], bool]
) -> Iterator[tuple[int, Run]]:
    """Yield (index of the instance in its suite, run) over the grid of one planner."""
    budgets = sorted(entry.budgets or experiment.budgets)
    by_itself = entry.objective != ACTIONS or entry.robust or dependent(entry.planner)
    kind: RunKind = "budget" if by_itself else "anytime"
    few = entry.instances or experiment.instances
    counts: list[int | None] = list(entry.buffers or experiment.buffers or []) or [None]
    for suite in entry.suites or experiment.suites:
        for index, filed in enumerate(_instances(suite, base)[:few]):
            for count in counts:
                instance = filed if count is None else with_buffers(filed, count)
                for variant in entry.variants or experiment.variants:
                    allowed = variant_options(variant)
                    assert allowed is not None
                    problem = Problem(instance, allowed)
                    for seed in experiment.seeds:
                        settings = entry.settings(seed)
                        for budget in budgets if kind == "budget" else budgets[-1:]:
                            stands_for = (budget,) if kind == "budget" else tuple(budgets)
                            job = Job(entry.planner, problem, settings, float(budget), experiment.memory)
                            yield (
                                index,
                                _run(experiment, entry.shown, suite, variant, kind, stands_for, job),
                            )


def _run(
    experiment: Experiment, label: str, suite: str, variant: str, kind: RunKind, budgets: tuple[float, ...], job: Job
) -> Run:
    return Run(_key(label, suite, kind, job), experiment.name, label, suite, variant, kind, budgets, job)


def _cutoffs(run: Run) -> Iterator[Run]:
    """Yield the same run with every smaller budget as its real limit."""
    for budget in run.budgets[:-1]:
        job = replace(run.job, budget=float(budget))
        key = _key(run.label, run.suite, "cutoff", job)
        yield replace(run, key=key, kind="cutoff", budgets=(budget,), job=job)


def _key(label: str, suite: str, kind: RunKind, job: Job) -> str:
    asked = asdict(SolveOptions.of(job.options, job.settings))  # in one, as in the keys of earlier records
    asked = {name: value for name, value in asked.items() if name not in _SINCE or value != _SINCE[name]}
    meant = [label, suite, kind, job.planner, asked, job.budget, job.memory]
    return hashlib.sha256(json.dumps([*meant, instance_hash(job.instance)]).encode()).hexdigest()[:20]


def not_installed(experiment: Experiment) -> dict[tuple[str, str | None], str]:
    """Return which of the experiment's planners and programs cannot run here, and why."""
    from smash.planners.milp.solvers import require_solver

    lacking = {}
    for entry in experiment.planners:
        planner = (entry.planner, entry.command)
        try:
            require_solver(entry.solver)
            get_planner(entry.planner)
            missing = None if entry.command is None else program_missing(entry.command)
            if missing is not None:
                lacking[planner] = f"{entry.name!r} is not installed: {missing}"
        except Unsupported as error:
            lacking[planner] = str(error)
        except (Exception, SystemExit):  # a planner that is broken, not missing: its runs say so
            continue
    return lacking


def budget_dependent(planner: str) -> bool:
    """Whether a planner must be run at each budget by itself; one that cannot be loaded says so in its runs."""
    try:
        loaded = get_planner(planner)
    except (Exception, SystemExit):
        return False
    return bool(getattr(loaded, "budget_dependent", not getattr(loaded, "anytime", False)))


def _instances(suite: str, base: Path) -> list[Instance]:
    return read_suite(suite if suite in suite_names() else str(set_directory(suite, base)))


def set_directory(suite: str, base: Path) -> Path:
    """Return where a set lies that is no committed one: kept beside the experiment in a results directory, or `base`.

    Raises:
        MalformedFile: where the list of kept sets is damaged.
    """
    kept = base / INSTANCES / SETS
    if kept.is_file():
        try:
            folder = parse_json(read_bytes(kept), str(kept)).get(suite)
        except AttributeError:
            raise MalformedFile(str(kept), "not an object of sets and their folders") from None
        if isinstance(folder, str):
            return base / INSTANCES / folder
    return base / suite
