"""One executor for all planners: carries out a plan in the partially grounded way and judges what came of it.

The order of events is the paper's: plan offline what can be planned, execute, look at the scene after a topple, bridge
the gaps online. With the default policy it also looks before each action, repairs motions that the scene has blocked,
tries a disturbed pick again, and asks for a new plan from the observed state where an action cannot be done.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import hypot
from time import perf_counter

import numpy as np

from smash.execution.episode import Arrangement, Episode, Failure, Origin, Performed, Times, Totals
from smash.execution.errors import ExecutionFailure, NoIk
from smash.execution.failures import Fell, NotAtGoal, OutOfReach, Slip
from smash.execution.grounding import Grounder, Task
from smash.execution.readback import read_state
from smash.execution.robot import READY, panda
from smash.execution.start import starting_poses
from smash.execution.steps import OPEN_SECONDS, OPENINGS, Grip, Move, Segment, Steps
from smash.execution.tabletop import Tabletop
from smash.execution.timing import Pace
from smash.execution.world import Frame, World
from smash.problem.errors import IllegalAction
from smash.problem.files import action_from_list, action_list
from smash.problem.model import TABLE, Action, Instance, Pick, Place, State, Topple
from smash.problem.plan import Plan
from smash.problem.rules import Law

Replanner = Callable[[Instance], Sequence[Action] | None]
"""From an observed instance to a plan for it, or None where the planner found none."""

GRASPED_WITHIN = 0.5
"""A held block's centre is within this share of its side of the tool."""
MOVED = 0.004
"""A block this far from where a motion was planned for [m] needs a new one."""
SCENE_ALLOWANCE = 0.006
"""Motions planned offline may come this much closer to revealed blocks than planned [m]."""
NEAR = 0.11
"""Loose blocks this near to a place can be in the hand's way there [m]."""
PAUSE = 0.05
"""Standing still between two motions, for the arm to catch up [s]."""
JUDGE_WAIT = 2.0
"""Success is judged on settled blocks, and again after this long [s]."""


@dataclass(frozen=True, slots=True)
class Policy:
    """What the executor does where the open pipeline would fail.

    Attributes:
        repair: Plan a motion again that the observed scene blocks.
        retries: How often a failed pick is tried again.
        replans: How often the task is planned anew; 0 for never.
    """

    repair: bool = True
    retries: int = 2
    replans: int = 8


OPEN = Policy(repair=False, retries=0, replans=0)
"""The paper's pipeline: only gap tasks are planned online, and the first failure ends the episode."""


class Executor:
    """Runs one episode in one world; make a new one for the next.

    Args:
        instance: What is rearranged.
        plan: A plan that the law accepts for it.
        tabletop: The scene.
        seed: Of the blocks' start and of the motion planner.
        policy: What to do about failures.
        replanner: Plans the task anew from an observed instance.
        gui: Open PyBullet's window.
        on_frame: Called with the world 25 times a simulated second.
    """

    def __init__(
        self,
        instance: Instance,
        plan: Plan,
        tabletop: Tabletop,
        *,
        seed: int = 0,
        policy: Policy | None = None,
        replanner: Replanner | None = None,
        gui: bool = False,
        on_frame: Frame | None = None,
    ) -> None:
        self.instance = instance
        self.plan = plan
        self.tabletop = tabletop
        self.seed = seed
        self.policy = policy or Policy()
        self.replanner = replanner
        self.law = Law(instance, plan.options)
        self.slots = tabletop.bind(instance)
        self.steps = Steps(tabletop.side, Pace(tabletop.velocity, tabletop.acceleration), seed)
        self.grounder = Grounder(self.steps, self.slots)
        self.performed: list[Performed] = []
        self.hand: str | None = None
        self.retries = 0
        self.replans = 0
        self.task_seconds = 0.0
        self._gui = gui
        self._on_frame = on_frame

    def run(self) -> Episode:
        """Carry out the plan and judge the result."""
        self.steps.warm_up()
        generator = np.random.default_rng(self.seed)
        poses = starting_poses(self.instance, self.slots, self.tabletop, generator)
        with World(self.tabletop, poses, READY, gui=self._gui, on_frame=self._on_frame) as world:
            self.world = world
            world.settle()
            failure = self._run_plan()
            return self._episode(failure, self._observe())

    def _run_plan(self) -> ExecutionFailure | None:
        """Plan, execute, judge, and begin anew from what is observed as long as the policy allows it."""
        actions = self.plan.actions or ()
        origin: Origin = "plan"
        tasks = self._ground(actions)
        self.offline = sum(task.seconds for task in tasks)
        while True:
            failure = self._carry_out(tasks, origin) or self._judge()
            if failure is None or self.replanner is None or self.replans >= self.policy.replans:
                return failure
            self.replans += 1
            again = self._plan_anew(failure)
            if again is None:
                return failure
            tasks, origin = again, "replan"

    def _ground(self, actions: Sequence[Action]) -> list[Task]:
        return self.grounder.ground(actions, self._observe(), self.world.poses(), self.world.commanded())

    def _carry_out(self, tasks: Sequence[Task], origin: Origin) -> ExecutionFailure | None:
        """Perform tasks until one fails or what is observed makes the rest of the plan senseless."""
        expected = self._observe()
        rest = [task.action for task in tasks]
        for task in tasks:
            rest.pop(0)
            try:
                self._perform(task, origin, expected, rest)
            except ExecutionFailure as failure:
                return failure
        return None

    def _perform(self, task: Task, origin: Origin, expected: State, rest: Sequence[Action]) -> None:
        """Perform one action, move `expected` on to what is observed, and record it.

        Raises:
            ExecutionFailure: where the action, or the rest of the plan after it, cannot be done.
        """
        row = Performed(step=len(self.performed) + 1, action=action_list(task.action), origin=origin)
        self.performed.append(row)
        row.times = Times(offline=task.seconds if origin == "plan" else 0.0)
        row.times.online = task.seconds if origin != "plan" else 0.0
        row.gap = task.segments is None and task.problem is None
        begun = row.begun = self.world.time
        try:
            self._attempt(task, row, expected)
            observed = self._observe()
            self.law.apply(expected, task.action)
            if observed.key() != expected.key() and not self._still_good(observed, rest):
                raise Fell(_difference(expected, observed))
            expected.piles, expected.table, expected.hand = observed.piles, observed.table, observed.hand
        except ExecutionFailure as failure:
            row.outcome, row.reason = failure.failure, str(failure)
            raise
        except IllegalAction as problem:
            row.outcome, row.reason = Fell.failure, str(problem)
            raise Fell(str(problem)) from None
        finally:
            row.times.execution = self.world.time - begun

    def _still_good(self, state: State, rest: Sequence[Action]) -> bool:
        """Whether the rest of the plan reaches the goal from `state` too."""
        ahead = state.copy()
        try:
            for action in rest:
                self.law.apply(ahead, action)
        except IllegalAction:
            return False
        return self.law.goal_shortfall(ahead) is None

    def _attempt(self, task: Task, row: Performed, state: State) -> None:
        """Perform an action, a pick several times where it fails."""
        tries = 1 + (self.policy.retries if isinstance(task.action, Pick) else 0)
        for attempt in range(1, tries + 1):
            row.attempts = attempt
            try:
                self._try(task if attempt == 1 else Task(task.action, None), row, state)
                return
            except ExecutionFailure:
                if attempt == tries:
                    raise
                self.retries += 1
                self.world.settle()

    def _try(self, task: Task, row: Performed, state: State) -> None:
        segments = task.segments
        if segments is None or not self._usable(task):
            row.repaired = row.repaired or segments is not None
            begun = perf_counter()
            try:
                segments = self._plan_online(task, state)
            finally:
                row.times.online += perf_counter() - begun
        match task.action:
            case Pick(block, _):
                carry_out(self.world, segments)
                self._require_grasp(block)
                self.hand = block
            case Place(block, target):
                carry_out(self.world, segments)
                self.hand = None
                self.world.wait(PAUSE)
                if self._observe().piles[target][-1:] != [block]:
                    raise Slip(f"block {block!r} does not stand on {target!r} after it was let go")
            case Topple():
                carry_out(self.world, segments)
                self.world.settle()

    def _plan_online(self, task: Task, state: State) -> list[Segment]:
        """Plan an action from the observed scene and the arm's present state."""
        poses, joints = self.world.poses(), self.world.commanded()
        try:
            try:
                again = self.grounder.task(task.action, state.piles, poses, joints, task.approach)
            except ExecutionFailure:
                if task.approach is None:
                    raise
                again = self.grounder.task(task.action, state.piles, poses, joints)
        except NoIk as problem:
            if isinstance(task.action, Pick) and task.action.source == TABLE:
                raise OutOfReach(f"block {task.action.block!r}: {problem}") from None
            raise
        return again.segments or []

    def _usable(self, task: Task) -> bool:
        """Whether a motion planned earlier starts where the arm is, and fits the scene (if the policy looks at it)."""
        moves = [segment for segment in task.segments or () if isinstance(segment, Move)]
        if moves and np.abs(moves[0].path.start - self.world.commanded()).max() > 1e-6:
            return False
        if not self.policy.repair:
            return True
        poses = self.world.poses()
        if isinstance(task.action, Pick) and moves:
            tool = panda().forward(moves[-2].path.end).position
            if hypot(*(poses[task.action.block].position - tool)[:2]) > MOVED:
                return False
        scene = self.steps.scene(poses)
        return all(move.free(scene, SCENE_ALLOWANCE) for move in moves)

    def _require_grasp(self, block: str) -> None:
        """Raise `Slip`, the hand opened, unless the block is between the fingers."""
        away = float(np.linalg.norm(self.world.pose(block).position - self.world.tool_position()))
        if away < GRASPED_WITHIN * self.tabletop.side:
            return
        self.world.grip(self.tabletop.side / 2 + OPENINGS[0], OPEN_SECONDS)
        raise Slip(f"block {block!r} is {away * 100:.1f} cm from the fingers after the grasp")

    def _observe(self) -> State:
        return read_state(self.world.poses(), self.slots, self.tabletop.side, self.hand)

    def _judge(self) -> ExecutionFailure | None:
        """Whether the settled blocks fulfil the goal, and still do after a wait."""
        self.world.settle()
        for _ in range(2):
            shortfall = self.law.goal_shortfall(self._observe())
            if shortfall is not None:
                return NotAtGoal(shortfall)
            self.world.wait(JUDGE_WAIT)
            self.world.settle()
        return None

    def _plan_anew(self, failure: ExecutionFailure) -> list[Task] | None:
        """Empty the hand, clear what was in the way, and ask for a plan from the observed state."""
        self.world.settle()
        last = self.performed[-1] if self.performed else None
        if self.hand is not None and not self._put_down():
            return None
        if last is not None and last.outcome in ("no motion", "slip", "IK", "out of reach"):
            self._clear(action_from_list(list(last.action), "episode"))
        state = self._observe()
        begun = perf_counter()
        actions = None if self.replanner is None else self.replanner(observed_instance(self.instance, state))
        self.task_seconds += perf_counter() - begun
        return None if actions is None else self._ground(actions)

    def _put_down(self) -> bool:
        """Place the held block where it is in nobody's way: an empty buffer first, any pile last."""
        block = self.hand
        assert block is not None
        piles = self._observe().piles
        order = {name: index for index, name in enumerate((*self.instance.buffers, *self.instance.stacks))}
        for target in sorted(piles, key=lambda name: (len(piles[name]) > 0, order[name])):
            try:
                self._perform(Task(Place(block, target), None), "recovery", self._observe(), ())
                return True
            except ExecutionFailure:
                if self.hand is None:
                    return True
        return False

    def _clear(self, action: Action) -> None:
        """Move what is in the way of an action that could not be done: a loose block, or a pile that hides one."""
        match action:
            case Pick(block, _):
                x, y = (float(value) for value in self.world.pose(block).position[:2])
                spared = {block}
            case Place(_, location) | Topple(location, _):
                x, y = self.slots[location].x, self.slots[location].y
                spared = set()
        poses, state = self.world.poses(), self._observe()
        loose = [name for name in state.table if name not in spared and poses[name].distance(x, y) < NEAR]
        for name in sorted(loose, key=lambda name: (-round(poses[name].position[2], 2), poses[name].distance(x, y))):
            if self._set_aside(name, TABLE):
                return
        if isinstance(action, Pick) and action.source == TABLE:
            self._uncover(action.block, x, y)

    def _uncover(self, block: str, x: float, y: float) -> None:
        """Take down the pile beside a loose block, one by one, until the block itself can be set aside."""
        near = [name for name, slot in self.slots.items() if slot.distance(x, y) < NEAR]
        for location in sorted(near, key=lambda name: self.slots[name].distance(x, y)):
            for _ in range(len(self._observe().piles[location])):
                pile = self._observe().piles[location]
                if not pile or not self._set_aside(pile[-1], location):
                    break
                if self._set_aside(block, TABLE):
                    return

    def _set_aside(self, block: str, source: str) -> bool:
        """Pick a block and put it down where it is in nobody's way; say whether the hand got it."""
        try:
            self._perform(Task(Pick(block, source), None), "recovery", self._observe(), ())
        except ExecutionFailure:
            if self.hand is None:
                return False
        self._put_down()
        return True

    def _episode(self, failure: ExecutionFailure | None, final: State) -> Episode:
        rows = self.performed
        last = rows[-1] if rows else None
        return Episode(
            instance=self.instance.name,
            planner=self.plan.planner,
            topple=self.plan.options.topple,
            max_topple=self.plan.options.max_topple,
            scene=self.tabletop.name,
            seed=self.seed,
            replanning=self.policy.replans > 0,
            success=failure is None,
            failure=None
            if failure is None
            else Failure(
                name=failure.failure,
                step=last.step if last else 0,
                action=last.action if last else None,
                reason=str(failure),
            ),
            plan_cost=len(self.plan.actions or ()),
            actions_executed=len(rows),
            replans=self.replans,
            retries=self.retries,
            times=Totals(
                offline=self.offline,
                online=sum(row.times.online for row in rows),
                execution=sum(row.times.execution for row in rows),
                task=self.task_seconds,
            ),
            final=Arrangement(piles={k: list(v) for k, v in final.piles.items() if v}, table=sorted(final.table)),
            actions=rows,
        )


def carry_out(world: World, segments: Sequence[Segment]) -> None:
    """Let the simulated arm and fingers do what was planned."""
    for segment in segments:
        if isinstance(segment, Grip):
            world.grip(segment.opening, segment.seconds)
        else:
            world.follow(segment.trajectory, segment.opening)
            world.wait(PAUSE)


def observed_instance(instance: Instance, state: State) -> Instance:
    """The instance that remains: the same goal from the observed state."""
    piles = {location: tuple(state.piles.get(location, ())) for location in instance.locations}
    table = tuple(block for block in instance.blocks if block in state.table)
    return Instance(instance.name, instance.blocks, instance.stacks, instance.buffers, piles, instance.goal, table)


def _difference(expected: State, observed: State) -> str:
    for location, pile in expected.piles.items():
        if observed.piles[location] != pile:
            return f"location {location!r} holds {observed.piles[location]}, expected {pile}"
    return f"the table region holds {sorted(observed.table)}, expected {sorted(expected.table)}"
