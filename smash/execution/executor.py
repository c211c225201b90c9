"""One executor for all planners: carries out a plan in the partially grounded way and judges what came of it.

The order of events is the paper's: plan offline what can be planned, execute, look at the scene after a topple, bridge
the gaps online. With the default policy it also looks before each action, repairs motions that the scene has blocked,
tries a disturbed pick again, and asks for a new plan from the observed state where an action cannot be done.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import asdict, replace
from time import perf_counter

import numpy as np

from smash.execution.ability import require_able
from smash.execution.actions.arm_motions import ArmMotions
from smash.execution.errors import Blind, Fell, NotAtGoal
from smash.execution.grounding import Grounder, Task
from smash.execution.observer import Eyes
from smash.execution.performing import SURE, Performer
from smash.execution.physics.engines import engine_of, world_of
from smash.execution.physics.world import Frame
from smash.execution.policy import Policy
from smash.execution.readback import NOWHERE, fallen_off
from smash.execution.recovery import Recovery
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.noise import Chance
from smash.execution.scene.piles import misfits, needs_of
from smash.execution.scene.start import starting_carriers, starting_poses
from smash.execution.scene.tabletop import DoesNotFit, Tabletop
from smash.execution.sight import Sight
from smash.execution.watching import DISTURBED, Watch, part_of, spoilt
from smash.problem.errors import ExecutionFailure, IllegalAction, Unsupported
from smash.problem.files.plans import action_from_list, action_list
from smash.problem.model import Action, Instance, PlanOptions, State
from smash.problem.plan import Plan
from smash.problem.rules import Law
from smash.records.episodes import Arrangement, Episode, Failure, Origin, Performed, Times, Totals

Replanner = Callable[[Instance, PlanOptions], Sequence[Action] | None]
"""From an observed instance and what plans may use to a plan for it, or None where the planner found none."""

TOPPLES_FAILED = 2
"""After so many failed topples in an episode, plans anew do without."""

JUDGE_WAIT = 2.0
"""Success is judged on settled blocks, and again after this long [s]."""


class Executor:
    """Runs one episode in one world; make a new one for the next.

    Args:
        instance: What is rearranged.
        plan: A plan that the law accepts for it.
        tabletop: The scene.
        seed: Of the blocks' start and of the motion planner.
        policy: What to do about failures.
        replanner: Plans the task anew from what is observed.
        eyes: Make the observer that is asked where the blocks are; the simulator's own where none are named.
        engine: What simulates it; the scene's, or the one that is there, where none is named.
        gui: Open the engine's window.
        on_frame: Called with the world 25 times a simulated second.
        on_step: Called with each action before it is carried out.

    Attributes:
        ended: Where everything was at the episode's end.

    Raises:
        DoesNotFit: where the scene has no room for the instance, or for the piles and topples of the plan, or the robot
            does not reach what it needs.
        Unsupported: where the robot cannot do an action, a block is in the hand at the start, or the engine is not
            installed.
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
        eyes: Eyes = Sight,
        engine: str | None = None,
        gui: bool = False,
        on_frame: Frame | None = None,
        on_step: Callable[[Performed], object] | None = None,
    ) -> None:
        if instance.hand is not None:
            raise Unsupported(
                f"instance {instance.name!r} starts with block {instance.hand!r} in the hand; "
                "the executor takes an empty hand alone"
            )
        self.instance = instance
        self.plan = plan
        self.tabletop = tabletop
        self.seed = seed
        self.policy = policy or Policy()
        self.replanner = replanner
        self._eyes = eyes
        self.engine = engine_of(tabletop, engine)
        self.law = Law(instance, plan.options)
        self.table = Geometry(tabletop.bind(instance), tabletop.bind_stations(instance))
        self.arm = ArmMotions(tabletop, seed)
        places = {**self.table.slots, **self.table.stations}
        actions, needs = plan.actions or (), needs_of(self.law, plan.actions or ())
        require_able(self.arm.robot, tabletop, actions, needs, places)
        for misfit in misfits(tabletop, instance, needs):
            raise DoesNotFit(misfit)
        self.chance = Chance(tabletop, instance, seed)
        self.grounder = Grounder(self.arm, self.chance.astray)
        self.performed: list[Performed] = []
        self.failed_at: Performed | None = None
        self.replans = 0
        self.task_seconds = 0.0
        self._gui = gui
        self._on_frame = on_frame
        self._on_step = on_step

    def run(self) -> Episode:
        """Carry out the plan and judge the result."""
        self.arm.warm_up()
        generator = np.random.default_rng(self.seed)
        carriers = starting_carriers(self.instance, self.table.stations, self.tabletop)
        poses = starting_poses(self.instance, self.table.slots, self.tabletop, generator, carriers)
        world = world_of(self.engine)(
            self.chance.scene(),
            self.chance.at_start(poses),
            self.arm.robot.ready,
            carriers=carriers,
            made=self.chance.made,
            gui=self._gui,
            on_frame=self._on_frame,
        )
        with world:
            self.world = world
            observer = self._eyes(world, self.chance)
            self.performer = Performer(world, self.grounder, self.table, self.policy, observer)
            self.recovery = Recovery(self.instance, self.performer, self._recover)
            world.settle()
            self.performer.look_around()
            self.watch = Watch(world.poses())
            self.noticing = Watch(self.performer.look().blocks, DISTURBED + 2 * SURE * self.tabletop.noise.pose)
            self.noticed: dict[str, float] = {}
            failure = self._run_plan()
            final = self.performer.truth()
            self.ended = self.table.seen(world.poses(), world.carriers())
            return self._episode(failure or self._unseen_shortfall(final), final)

    def _unseen_shortfall(self, final: State) -> ExecutionFailure | None:
        """What is missing of a goal that is seen fulfilled: success is judged by where the blocks are."""
        shortfall = self.law.goal_shortfall(final)
        return None if shortfall is None else NotAtGoal(f"{shortfall}, which was not seen")

    def _run_plan(self) -> ExecutionFailure | None:
        """Plan, execute, judge, and begin anew from what is observed as long as the policy allows it."""
        origin: Origin = "plan"
        failure = self._blindness() or self._start_shortfall()
        tasks = self._ground(self.plan.actions or (), self.law) if failure is None else []
        self.offline = sum(task.seconds for task in tasks)
        self.offline_cpu = sum(task.cpu_seconds for task in tasks)
        while True:
            failure = failure or self._perform_all(tasks, origin) or self._judge()
            self.failed_at = self.performed[-1] if self.performed else None
            hopeless = failure is None or isinstance(failure, Blind)
            if hopeless or self.replanner is None or self.replans >= self.policy.replans:
                return failure
            self.replans += 1
            again = self._plan_anew()
            if again is None:
                return failure
            tasks, origin, failure = again, "replan", None

    def _blindness(self) -> ExecutionFailure | None:
        """Whether some block cannot be seen well enough to be grasped ever: said before anything moves."""
        try:
            for block in self.instance.blocks:
                self.performer.study(block)
        except Blind as failure:
            return failure
        return None

    def _start_shortfall(self) -> ExecutionFailure | None:
        """Whether the piles stand that the instance starts with."""
        start, observed = State.start_of(self.instance), self.performer.observe()
        return None if observed.key() == start.key() else Fell(f"at the start, {_difference(start, observed)}")

    def _ground(self, actions: Sequence[Action], law: Law) -> list[Task]:
        return self.grounder.ground(actions, law, self.performer.look(), self.world.commanded())

    def _perform_all(self, tasks: Sequence[Task], origin: Origin) -> ExecutionFailure | None:
        """Perform tasks until one fails or what is observed makes the rest of the plan senseless."""
        expected = self.performer.observe()
        for number, task in enumerate(tasks, start=1):
            try:
                self._perform(task, origin, expected, tasks[number:])
            except ExecutionFailure as failure:
                return failure
        return None

    def _perform(self, task: Task, origin: Origin, expected: State, rest: Sequence[Task] | None) -> None:
        """Perform one action, move `expected` on to what is observed, and record it.

        Args:
            task: The action and what is planned of it.
            origin: Who asked for it.
            expected: The law's state before it.
            rest: What the plan goes on with, or None where a new plan comes anyway.

        Raises:
            ExecutionFailure: where the action, or the rest of the plan after it, cannot be done.
        """
        row = Performed(step=len(self.performed) + 1, action=action_list(task.action), origin=origin)
        self.performed.append(row)
        if origin == "plan":
            row.times = Times(offline=task.seconds, offline_cpu=task.cpu_seconds)
        else:
            row.times = Times(online=task.seconds, online_cpu=task.cpu_seconds)
        if self._on_step is not None:
            self._on_step(row)
        row.gap = origin != "recovery" and task.segments is None and task.problem is None
        begun = row.begun = self.world.time
        part = part_of(task.action, expected)
        try:
            try:
                self.performer.perform(task, row, expected)
            finally:
                self._note(row, part)
            observed = self._all_on_table()
            self.law.apply(expected, task.action)
            observed.origin = expected.origin
            if rest is not None:
                self._require_way_on(expected, observed, rest)
            expected.piles, expected.table, expected.hand = observed.piles, observed.table, observed.hand
            expected.carried, expected.stations = observed.carried, observed.stations
        except ExecutionFailure as failure:
            row.outcome, row.reason = failure.failure, str(failure)
            raise
        except IllegalAction as problem:
            row.outcome, row.reason = Fell.failure, str(problem)
            raise Fell(str(problem)) from None
        finally:
            row.times.execution = self.world.time - begun

    def _note(self, row: Performed, part: Collection[str]) -> None:
        """Record what an action has moved and touched that it is not about."""
        row.disturbed |= self.watch.disturbed(self.world.poses(), {*part, *row.aside})
        row.touched += [block for block in self.world.touched() if block not in row.touched]
        self.performer.sight.forget({*part, *row.touched})
        self.noticed = self.noticing.disturbed(self.performer.look().blocks, part)

    def _require_way_on(self, expected: State, observed: State, rest: Sequence[Task]) -> None:
        """Raise where the rest of the plan cannot follow on what an action has left.

        Raises:
            Fell: where the law does not lead on from there, or (where no motion is looked at again) a block that was
                disturbed lies in the way of a motion that is planned.
        """
        if observed.key() != expected.key() and not self._still_good(observed, [task.action for task in rest]):
            raise Fell(_difference(expected, observed))
        if self.policy.repair:
            return
        for block, far in self.noticed.items():
            spoiled = spoilt(rest, block, self.performer.look().blocks[block], self.arm)
            if spoiled is not None:
                words = " ".join(map(str, action_list(spoiled.action)))
                raise Fell(f"block {block!r} was moved by {far * 100:.1f} cm; {words!r} was planned without that")

    def _all_on_table(self) -> State:
        """The law's state as observed.

        Raises:
            Fell: where a block is not on the table any more.
        """
        lost = fallen_off(self.performer.look().blocks)
        if lost:
            raise Fell(f"block {lost[0]!r} fell off the table")
        return self.performer.observe()

    def _recover(self, action: Action) -> None:
        self._perform(Task(action, None), "recovery", self.performer.observe(), None)

    def _still_good(self, state: State, rest: Sequence[Action]) -> bool:
        """Whether the rest of the plan reaches the goal from `state` too."""
        ahead = state.copy()
        try:
            for action in rest:
                self.law.apply(ahead, action)
        except IllegalAction:
            return False
        return self.law.goal_shortfall(ahead) is None

    def _judge(self) -> ExecutionFailure | None:
        """Whether the settled blocks fulfil the goal, and still do after a wait."""
        self.world.settle()
        for _ in range(2):
            try:
                shortfall = self.law.goal_shortfall(self._all_on_table())
            except Fell as failure:
                return failure
            if shortfall is not None:
                return NotAtGoal(shortfall)
            self.world.wait(JUDGE_WAIT)
            self.world.settle()
            if self.performed:
                self._note(self.performed[-1], ())
        return None

    def _plan_anew(self) -> list[Task] | None:
        """Empty the hand, clear what was in the way, and ask for a plan from the observed state; None without one."""
        self.world.settle()
        last = self.failed_at
        if self.performer.hand is not None and not self.recovery.put_down():
            return None
        if last is not None and last.outcome in ("no motion", "slip", "IK", "out of reach"):
            self.recovery.clear(action_from_list(list(last.action), "episode"))
        state = self.performer.observe()
        lost = fallen_off(self.performer.look().blocks)
        if lost or self.performer.hand is not None or NOWHERE in state.stations.values():
            return None
        remaining = observed_instance(self.instance, state)
        begun = perf_counter()
        actions = self._ask(remaining)
        self.task_seconds += perf_counter() - begun
        return None if actions is None else self._ground(actions, Law(remaining, self.plan.options))

    def _ask(self, instance: Instance) -> Sequence[Action] | None:
        """A plan for what is observed that fits the scene, without topples where they keep failing."""
        if self.replanner is None:
            return None
        options = self.plan.options
        failed = sum(row.action[0] == "topple" and row.outcome != "done" for row in self.performed)
        asked = (options, replace(options, topple=False)) if options.topple else (options,)
        for allowed in asked if failed < TOPPLES_FAILED else reversed(asked):
            actions, law = self.replanner(instance, allowed), Law(instance, self.plan.options)
            if actions is None or not law.check(actions).accepted:
                continue
            if not any(misfits(self.tabletop, instance, needs_of(law, actions))):
                return actions
        return None

    def _episode(self, failure: ExecutionFailure | None, final: State) -> Episode:
        rows = self.performed
        last = self.failed_at
        return Episode(
            instance=self.instance.name,
            planner=self.plan.planner,
            topple=self.plan.options.topple,
            max_topple=self.plan.options.max_topple,
            scene=self.tabletop.name,
            engine=self.engine,
            robot=self.arm.robot.label,
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
            plan_cost=self.law.price(self.plan.actions or ()),
            actions_executed=len(rows),
            replans=self.replans,
            retries=self.performer.retries,
            times=Totals(
                offline=self.offline,
                offline_cpu=self.offline_cpu,
                online=sum(row.times.online for row in rows),
                online_cpu=sum(row.times.online_cpu for row in rows),
                execution=sum(row.times.execution for row in rows),
                task=self.task_seconds,
            ),
            final=Arrangement(
                piles={k: list(v) for k, v in final.piles.items() if v},
                table=sorted(final.table),
                carried={k: sorted(v) for k, v in final.carried.items()},
                stations={k: None if v == NOWHERE else v for k, v in final.stations.items()},
            ),
            actions=rows,
            noise={kind: amount for kind, amount in asdict(self.tabletop.noise).items() if amount},
            speed=(self.tabletop.velocity, self.tabletop.acceleration),
        )


def observed_instance(instance: Instance, state: State) -> Instance:
    """The instance that remains: the same goal from the observed state."""
    carriers = tuple(
        replace(carrier, at=state.stations[carrier.name], holds=tuple(sorted(state.carried[carrier.name])))
        for carrier in instance.carriers
    )
    return replace(
        instance,
        start={location: tuple(state.piles.get(location, ())) for location in instance.locations},
        table=tuple(block for block in instance.blocks if block in state.table),
        carriers=carriers,
    )


def _difference(expected: State, observed: State) -> str:
    for location, pile in expected.piles.items():
        if observed.piles[location] != pile:
            return f"location {location!r} holds {observed.piles[location]}, expected {pile}"
    for carrier, station in expected.stations.items():
        if observed.stations[carrier] != station:
            return f"carrier {carrier!r} does not stand at {station!r}"
        if observed.carried[carrier] != expected.carried[carrier]:
            held, wanted = sorted(observed.carried[carrier]), sorted(expected.carried[carrier])
            return f"carrier {carrier!r} holds {held}, expected {wanted}"
    return f"the table region holds {sorted(observed.table)}, expected {sorted(expected.table)}"
