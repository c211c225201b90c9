"""A rehearsal of a plan: every motion is planned as the executor would, and nothing is simulated.

What a topple takes and where its blocks land is drawn from the trials of an outcome model; the rest of an episode is
motions whose durations are known as soon as they are planned. A rehearsal takes some hundredths of a second an action.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smash.execution.actions.arm_motions import PAUSE, ArmMotions, duration
from smash.execution.actions.grasps import CENTRED, Grasp
from smash.execution.actions.topple import directions, pushes_needed
from smash.execution.grounding import Grounder, Task
from smash.execution.scene.block_pose import standing
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.start import starting_poses
from smash.execution.scene.tabletop import Tabletop
from smash.forecast.model import OutcomeModel
from smash.motion.move import Move
from smash.motion.poses import Vector
from smash.problem.actions.topple import Topple
from smash.problem.errors import ExecutionFailure
from smash.problem.model import Action, Place, State
from smash.problem.problem import Problem

SETTLING = 0.3
"""After a push the executor waits about so long until nothing moves any more [s]."""
SAME = 1e-6
"""Joint positions that differ by less are the same [rad]."""


@dataclass(frozen=True, slots=True)
class Rehearsed:
    """An action as it was rehearsed.

    Attributes:
        action: the action.
        seconds: what it would take; None where no motion was found, or where a topple was never tried.
    """

    action: Action
    seconds: float | None


class Rehearsal:
    """Rehearses plans in one scene.

    Args:
        tabletop: The scene.
        model: Draws topples; None where no plan has one.
    """

    def __init__(self, tabletop: Tabletop, model: OutcomeModel | None = None) -> None:
        self.tabletop = tabletop
        self.model = model

    def of(self, problem: Problem, actions: Sequence[Action], seed: int = 0) -> list[Rehearsed]:
        """Rehearse a legal plan.

        Args:
            problem: What is planned.
            actions: The plan.
            seed: Of start poses, landings and motion planning.

        Raises:
            DoesNotFit: where the scene has no room for the instance.
        """
        generator = np.random.default_rng(seed)
        grounder = Grounder(ArmMotions(self.tabletop, seed))
        slots = self.tabletop.bind(problem.instance)
        where = Geometry(slots, blocks=starting_poses(problem.instance, slots, self.tabletop, generator))
        tasks = grounder.ground(actions, problem.law, where, grounder.arm.robot.ready)
        return _Run(self, grounder, where, generator).through(problem, tasks)


class _Run:
    """One rehearsal under way."""

    def __init__(
        self,
        rehearsal: Rehearsal,
        grounder: Grounder,
        where: Geometry,
        generator: np.random.Generator,
    ) -> None:
        self._rehearsal = rehearsal
        self._grounder = grounder
        self._where = where
        self._generator = generator
        self._joints: Vector = grounder.arm.robot.ready
        self._grasp: Grasp = CENTRED

    def through(self, problem: Problem, tasks: Sequence[Task]) -> list[Rehearsed]:
        rehearsed = []
        state = State.start_of(problem.instance)
        for task in tasks:
            seconds = self._topple(task, state) if isinstance(task.action, Topple) else self._move(task, state)
            problem.law.carry_out(state, task.action)
            rehearsed.append(Rehearsed(task.action, seconds))
        return rehearsed

    def _topple(self, task: Task, state: State) -> float | None:
        action = task.action
        assert isinstance(action, Topple)
        slot = self._where.slots[action.location]
        fallen = state.piles[action.location][action.height - 1 :]
        others = [pose for name, pose in self._where.blocks.items() if name not in state.piles[action.location]]
        way = directions(slot, len(fallen), others, self._rehearsal.tabletop.side)[0]
        model = self._rehearsal.model
        trials = model.trials(action.height, len(fallen)) if model is not None else ()
        trials = tuple(trial for trial in trials if trial.landed)
        planned = self._planned(task, state)
        if not trials:
            for block in fallen:
                self._where.blocks.pop(block, None)
            return None
        drawn = trials[int(self._generator.integers(len(trials)))]
        for level, block in enumerate(fallen):
            landed = drawn.landed[min(level, len(drawn.landed) - 1)]
            x, y = slot.point(landed.along, landed.aside, way)
            self._where.blocks[block] = standing(x, y, self._rehearsal.tabletop.side / 2, slot.angle)
        if planned is None:
            return None
        if pushes_needed(action.height, len(state.piles[action.location])) > 1:
            return drawn.seconds
        return duration(planned.segments or ()) + SETTLING

    def _move(self, task: Task, state: State) -> float | None:
        planned, waited = self._planned(task, state), 0.0
        if isinstance(task.action, Place):
            target = task.action.target
            self._where.blocks[task.action.block] = self._grounder.stand(target, state, self._where)
            waited = PAUSE
        return None if planned is None else duration(planned.segments or ()) + waited

    def _planned(self, task: Task, state: State) -> Task | None:
        """The task as it was planned before, or planned from where the arm is now; None where there is no motion."""
        done = task if self._usable(task) else self._bridged(task, state)
        if done is not None and done.segments:
            self._joints, self._grasp = (
                [part for part in done.segments if isinstance(part, Move)][-1].path.end,
                done.grasp,
            )
        return done

    def _usable(self, task: Task) -> bool:
        moves = [part for part in task.segments or () if isinstance(part, Move)]
        fits = task.approach is None or task.approach.grasp == self._grasp
        return bool(moves) and fits and bool(np.abs(moves[0].path.start - self._joints).max() < SAME)

    def _bridged(self, task: Task, state: State) -> Task | None:
        promised = task.approach if task.approach is not None and task.approach.grasp == self._grasp else None
        for approach in dict.fromkeys((promised, None)):
            try:
                return self._grounder.task(task.action, state, self._where, self._joints, approach, self._grasp)
            except ExecutionFailure:
                continue
        return None
