"""Episodes of a sweep's plans: each recorded plan is carried out under several seeds, recorded one line an episode.

`RESULTS/runs.jsonl` holds the plans, `RESULTS/episodes.jsonl` gets the episodes. They run in processes of their own, so
that a crash of the physics costs one episode alone; a stopped run is continued where it ended.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from threading import Event
from time import perf_counter
from typing import Any, cast

import msgspec

from smash.experiments.environment import commit, load, machine, versions
from smash.experiments.episodes.question import EpisodeRun
from smash.experiments.episodes.simulation import Simulation
from smash.experiments.isolation.hearing import done
from smash.problem.errors import SmashError
from smash.problem.files.instances import instance_from_document
from smash.problem.files.typed import typed
from smash.problem.model import Instance, PositionsGoal
from smash.records.believing import judge
from smash.records.episodes import EPISODE_RUN_FORMAT, ROBOT, Episode, EpisodeRecord
from smash.records.files import RUNS
from smash.records.reading import read

REPLAYS = "replays"
POLICIES = ("replan", "open")
"""`replan`: the executor repairs, retries and replans; `open`: the paper's open pipeline."""


def told_apart(scene: str | os.PathLike[str] | None, noise: str | None = None, pace: float | None = None) -> str | None:
    """Return the name of a scene with what tells it from any other; None for the built-in scene as it is.

    Args:
        scene: Its file, or None for the built-in scene.
        noise: In place of its own.
        pace: The same.
    """
    from smash.execution.scene.scene_file import scene_of

    name = scene_name(scene, noise, pace)
    return None if name is None else f"{name}-{scene_of(scene, noise, pace).fingerprint}"


def scene_name(scene: str | os.PathLike[str] | None, noise: str | None = None, pace: float | None = None) -> str | None:
    """Return what records call a scene, with the noise and the pace that take the place of its own."""
    if scene is None and noise is None and pace is None:
        return None
    from smash.execution.scene.noise import noise_words, parse_noise

    words = ["default" if scene is None else Path(scene).stem]
    words += [] if noise is None else [noise_words(parse_noise(noise)) or "exact"]
    words += [] if pace is None else [f"pace={pace:g}"]
    return " ".join(words)


def scene_document(
    scene: str | os.PathLike[str] | None, noise: str | None, pace: float | None, robot: str | None
) -> dict[str, Any]:
    """Return a scene as plain data, which goes to processes and machines that do not see its file."""
    from smash.execution.scene.scene_file import scene_of

    return cast("dict[str, Any]", msgspec.to_builtins(scene_of(scene, noise, pace, robot)))


def robot_label(scene: str | os.PathLike[str] | None, robot: str | None) -> str:
    """Return what records call the robot that is named, or else the scene's."""
    if scene is None and robot is None:
        return ROBOT
    from smash.execution.scene.scene_file import scene_of
    from smash.motion.robots import load_robot

    return load_robot(scene_of(scene, robot=robot).robot).label


def episode_runs(
    results: Path,
    seeds: Sequence[int],
    policies: Sequence[str],
    scene: str | None = None,
    labels: Sequence[str] = (),
    replays: bool = False,
    told: str | None = None,
    noise: str | None = None,
    pace: float | None = None,
    engine: str = "pybullet",
    robot: str | None = None,
    called: str | None = None,
) -> list[EpisodeRun]:
    """Return the episodes of all plans that a sweep has recorded, seed by seed, so that a part is a fair sample.

    Args:
        results: The sweep's directory.
        seeds: Of the episodes.
        policies: Of `POLICIES`.
        scene: A scene file, or None for the built-in scene.
        labels: Only plans of planners so labelled; all where there are none.
        replays: Write a replay page of each plan's first episode beside the records.
        told: What tells the scene from others; found out where it is not given.
        noise: In place of the scene's own.
        pace: The same.
        engine: What simulates them.
        robot: The robot that stands at the scene, by name or file, in place of the scene's own.
        called: What records call it; found out where it is not given.

    Raises:
        MalformedFile: where the records are damaged.
        SmashError: where nobody is labelled so.
    """
    reading = read(results, RUNS)
    judged = [run.record for run in judge(reading.records) if run.counts]
    plans = [run for run in judged if run.actions is not None and run.kind != "cutoff"]
    known = {run.label for run in plans}
    for label in labels:
        if label not in known:
            raise SmashError(f"{reading.path}: no plan by {label!r}; there are plans by {', '.join(sorted(known))}")
    plans = [record for record in plans if not labels or record.label in labels]
    name, told = scene_name(scene, noise, pace), told or told_apart(scene, noise, pace)
    tabletop = None if name is None and robot is None else scene_document(scene, noise, pace, robot)
    called = called or robot_label(scene, robot)
    runs = [
        EpisodeRun(record, seed, policy, name, told, tabletop, engine=engine, robot=called)
        for seed in seeds
        for record in plans
        for policy in policies
    ]
    if not replays:
        return runs
    replace = msgspec.structs.replace
    return [replace(run, replay=_replay(results, run)) if run.seed == seeds[0] else run for run in runs]


def _replay(results: Path, run: EpisodeRun) -> str:
    """The page of an episode: instance, planner, variant, policy and scene in words that any file system takes."""
    words = [run.record.instance, run.record.label, run.record.variant, run.policy]
    words += [] if run.told is None else [run.told]
    words += [] if run.engine == "pybullet" else [run.engine]
    words += [] if run.robot == ROBOT else [run.robot]
    name = re.sub(r"[^A-Za-z0-9.-]+", "-", "_".join(words)).strip("-")
    return str((results / REPLAYS / f"{name}.html").resolve())


def run_episode(run: EpisodeRun, stop: Event | None = None) -> EpisodeRecord | None:
    """Run one episode in processes of its own; None where `stop` was set before it ended.

    The record's `episode` is None where those processes ended badly.

    Raises:
        SmashError: where no episode can be run on this machine.
    """
    if stop is not None and stop.is_set():
        return None
    started, begun, before = datetime.now(UTC), perf_counter(), load()
    ended = done(Simulation(run), stop)
    if ended.interrupted:
        return None
    episode = None if ended.answer is None else typed(ended.answer, Episode)
    return _record(run, episode, ended.reason, started, perf_counter() - begun, before)


def _record(
    run: EpisodeRun, episode: Episode | None, problem: str, started: datetime, seconds: float, before: float
) -> EpisodeRecord:
    plan = run.record
    instance = instance_from_document(plan.instance_document)
    assert plan.cost is not None  # episodes are of plans
    return EpisodeRecord(
        format=EPISODE_RUN_FORMAT,
        key=run.key,
        run=plan.key,
        instance=plan.instance,
        suite=plan.suite,
        label=plan.label,
        variant=plan.variant,
        policy=run.policy,
        seed=run.seed,
        scene=run.scene,
        engine=run.engine,
        robot=run.robot,
        blocks=len(instance.blocks),
        depth=target_depth(instance),
        cost=plan.cost,
        status=plan.status,
        budget=plan.budget,
        first_plan_seconds=plan.incumbents[0][0] if plan.incumbents else None,
        best_plan_seconds=plan.incumbents[-1][0] if plan.incumbents else None,
        episode=episode,
        problem=problem,
        wall_seconds=seconds,
        started=started.isoformat(timespec="milliseconds"),
        load_average=(before, load()),
        commit=commit(),
        machine=machine(),
        versions=versions("greedy") | execution_versions(run.engine),
    )


def execution_versions(engine: str) -> dict[str, str]:
    """Return the versions of what moves the arm, and of the engine that simulates it."""
    from importlib.metadata import version

    return {name: version(name) for name in (engine, "ompl", "pin", "coal", "toppra")}


def target_depth(instance: Instance) -> int | None:
    """Depth of a single-goal instance's target in its start pile, the top being 1; None for other goals."""
    goal = instance.goal
    if not isinstance(goal, PositionsGoal) or len(goal.positions) != 1:
        return None
    target = next(iter(goal.positions))
    for pile in instance.start.values():
        if target in pile:
            return len(pile) - pile.index(target)
    return None
