"""Inside the process of a simulation: carry out a plan or topple a pile, and say what became of it."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import msgspec

from smash.experiments.episodes.executors import executor_of
from smash.experiments.episodes.question import EpisodeRun, TrialRun
from smash.experiments.episodes.simulation import Simulation
from smash.experiments.isolation.voice import Voice, to_its_end
from smash.problem.errors import SmashError
from smash.problem.extras import MissingExtra, missing_extra
from smash.problem.files.instances import instance_from_document
from smash.problem.files.typed import typed
from smash.records.episodes import Episode, episode_text
from smash.records.trials import Trial

if TYPE_CHECKING:
    from smash.execution.scene.tabletop import Tabletop


def load() -> None:
    """Load, once for all simulations, what they have in common, and its compiled code; no engine is opened.

    What is not installed is said by the simulation that wants it.
    """
    with suppress(ImportError):
        import smash.execution.executor
        import smash.execution.trials.topple_map  # noqa: F401
        from smash.execution.actions.arm_motions import ArmMotions
        from smash.execution.scene.scene_file import default_scene

        ArmMotions(default_scene()).warm_up()


def simulate(work: Simulation, pipe: int) -> NoReturn:
    """Do it and end the process."""
    voice = Voice(pipe)
    to_its_end(voice, lambda: _simulate(work.question, voice))


def _simulate(question: EpisodeRun | TrialRun, voice: Voice) -> None:
    voice.say(kind="solving")
    try:
        answer = _answer(question)
    except (ModuleNotFoundError, MissingExtra) as error:
        lacking = error if isinstance(error, MissingExtra) else missing_extra(error, "a simulation")
        if lacking is None:
            raise
        return voice.say(kind="failed", outcome="not-installed", reason=str(lacking))
    return voice.say(kind="result", answer=answer)


def _answer(question: EpisodeRun | TrialRun) -> Any:
    if isinstance(question, EpisodeRun):
        return json.loads(episode_text(carry_out(question)))
    return msgspec.to_builtins(topple(question))


def carry_out(run: EpisodeRun) -> Episode:
    """Carry out the plan of a sweep's record.

    Raises:
        SmashError: where the robot's file is another one here than where the episode was asked for.
    """
    from smash.execution.viewing.capture import Capture

    instance = instance_from_document(run.record.instance_document)
    capture = Capture(replay=None if run.replay is None else Path(run.replay))
    executor = executor_of(
        instance,
        run.record.plan,
        seed=run.seed,
        replan=run.policy != "open",
        scene=None if run.tabletop is None else _tabletop(run.tabletop),
        engine=run.engine,
        on_frame=capture.frame,
    )
    robot = executor.arm.robot
    if robot.label != run.robot:
        raise SmashError(f"robot {run.robot!r} was asked for, and {robot.path} holds {robot.label!r} now")
    episode = executor.run()
    capture.finish(executor, episode)
    return episode


def topple(run: TrialRun) -> Trial:
    """Do a trial of a topple."""
    from smash.execution.trials.topple_map import run_trial

    _, stack, height, falling, seed = run.key
    return run_trial(_tabletop(run.tabletop), stack, height, falling, seed, run.engine)


def _tabletop(document: dict[str, Any]) -> Tabletop:
    from smash.execution.scene.tabletop import Tabletop

    return typed(document, Tabletop)
