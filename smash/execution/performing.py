"""One action in the simulated world: its planned motions, or new ones where the scene asks for them, and their check.

The law's view of the world is read here too (`observe`): what stands where, what lies in the table region, and which
block is in the hand.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from math import hypot, inf

import numpy as np

from smash.execution.actions.arm_motions import OPEN_SECONDS, OPENINGS, PAUSE, Grip, Segment
from smash.execution.actions.grasps import CENTRED, Grasp
from smash.execution.actions.pick_and_place import Approach
from smash.execution.actions.registry import MOTIONS
from smash.execution.errors import Blind, OutOfReach, Slip
from smash.execution.grounding import Grounder, Task
from smash.execution.observer import Observer
from smash.execution.physics.world import World
from smash.execution.policy import Policy
from smash.execution.readback import read_state
from smash.execution.scene.block_pose import standing
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.region import covering, free_places
from smash.execution.sight import MEMORY
from smash.execution.stopwatch import Stopwatch
from smash.motion.errors import NoIk, NoMotion
from smash.motion.move import Move
from smash.problem.errors import ExecutionFailure
from smash.problem.model import TABLE, Aggregating, Pick, Place, State
from smash.records.episodes import Performed

GRASPED_WITHIN = 0.5
"""A held block's centre is within this share of its footprint's side of the tool."""
HELD_OPENING = 0.25
"""Where blocks are not seen exactly, the fingers tell: they stand this share of a block's width or more from the
middle."""
SURE = 3.0
"""A block is taken to be no further from where it is seen than so many standard deviations."""
WORTH = 0.99
"""Another look is worth it where the last one has brought what is not known down to this share of it or less."""
LOOK_SECONDS = 1 / 30
"""From one look to the next, where one is not enough [s]."""
MOVED = 0.004
"""A block this far from where a motion was planned for [m] needs a new one."""
SCENE_ALLOWANCE = 0.006
"""Motions planned offline may come this much closer to revealed blocks than planned [m]."""
PLACES = 12
"""Places in the table region that are tried for a block that lies on another."""
MOST_MOTIONS = 5
"""An aggregating action is not repeated more often than this: what it leaves undone then, the law's state tells."""


class Performer:
    """The arm, the hand and the eyes of one episode.

    Args:
        world: Where it happens.
        grounder: Plans motions.
        table: The slots of locations and stations.
        policy: What to do about failures.
        sight: Sees where the blocks are.

    Attributes:
        hand: The block between the fingers, or none.
        grasp: How they hold it.
        retries: How many picks were tried again.
    """

    def __init__(self, world: World, grounder: Grounder, table: Geometry, policy: Policy, sight: Observer) -> None:
        self.world = world
        self.sight = sight
        self.grounder = grounder
        self.table = table
        self.policy = policy
        self.hand: str | None = None
        self.grasp = CENTRED
        self.retries = 0

    def observe(self) -> State:
        """The law's state in the scene as it is seen."""
        tabletop = self.world.tabletop
        return read_state(self.look(), tabletop, self.hand, tabletop.noise)

    def truth(self) -> State:
        """The law's state in the scene as it is, which the executor does not know."""
        where = self.table.seen(self.world.poses(), self.world.carriers())
        return read_state(where, self.world.tabletop, self.hand)

    def look(self) -> Geometry:
        """Where things are, as far as it can be seen."""
        return self.table.seen(self.sight.blocks(), self.sight.carriers())

    def look_around(self) -> None:
        """Look for a while, where one look is not exact."""
        if not self.sight.exact:
            for _ in range(MEMORY):
                self.look()
                self.world.wait(LOOK_SECONDS)

    def study(self, block: str) -> None:
        """Look until a block is known well enough for the open hand to come down around it.

        Raises:
            Blind: where more looks would not do.
        """
        if self.sight.exact:
            return
        self.look()
        most, before = self.world.robot.hand.opening - self.world.tabletop.size(block).footprint / 2, inf
        while (beside := SURE * self.sight.spread(block)) > OPENINGS[0] and beside < WORTH * before:
            before = beside
            self.world.wait(LOOK_SECONDS)
            self.look()
        if beside > most:
            room = f"the open hand leaves {most * 1e3:.1f} mm"
            raise Blind(f"block {block!r} may lie {beside * 1e3:.1f} mm beside where it is seen; {room}")

    def perform(self, task: Task, row: Performed, state: State) -> None:
        """Perform an action, a pick several times where the block slips.

        Args:
            task: The action and what is planned of it.
            row: Gets attempts, repairs and the time of planning online.
            state: The law's state before it.

        Raises:
            ExecutionFailure: where it cannot be done.
        """
        tries = 1 + (self.policy.retries if isinstance(task.action, Pick) else 0)
        for attempt in range(1, tries + 1):
            row.attempts = attempt
            try:
                self._try(task if attempt == 1 else Task(task.action, None), row, state)
                return
            except Slip:
                if attempt == tries:
                    raise
                self.retries += 1
                self.world.settle()

    def _try(self, task: Task, row: Performed, state: State) -> None:
        match task.action:
            case Pick(block, _):
                self.study(block)
            case Aggregating() if type(task.action) in MOTIONS:
                grasped = MOTIONS[type(task.action)].grasped(task.action, state)
                if grasped is not None:
                    self.study(grasped)
        if task.segments is None or not self._usable(task, state):
            row.repaired = row.repaired or task.segments is not None
            task = self._within_reach(task, state, row)
        segments = task.segments or []
        match task.action:
            case Pick(block, _):
                follow(self.world, segments)
                self._require_grasp(block, task.grasp)
                self.hand, self.grasp = block, task.grasp
            case Place(block, target):
                follow(self.world, segments)
                self.hand = None
                self.world.wait(PAUSE)
                if not _stands_on(block, target, self.observe()):
                    raise Slip(f"block {block!r} does not stand on {target!r} after it was let go")
            case Aggregating():
                self._aggregate(task.action, segments, row)

    def _aggregate(self, action: Aggregating, segments: Sequence[Segment], row: Performed) -> None:
        """Perform, look, and go on as long as the action is not done: many blocks fall in several pushes.

        The open pipeline makes as many motions as the action was meant to take, and no more.
        """
        motion = MOTIONS[type(action)]
        most = (
            MOST_MOTIONS
            if self.policy.repair
            else motion.motions(self.grounder.arm, action, self.observe(), self.look())
        )
        for number in range(1, most + 1):
            follow(self.world, segments)
            self.world.settle()
            state = self.observe()
            if number == most or not motion.unfinished(action, state):
                return
            segments = self._planned(Task(action, None), state, row).segments or []

    def _within_reach(self, task: Task, state: State, row: Performed) -> Task:
        """Plan an action online; a pick from the table region that finds no room, once what lies on the block is away.

        To the law all blocks of the table region lie side by side: that one has come to rest on another is for the
        arm to mend, as part of the pick.
        """
        try:
            return self._planned(task, state, row)
        except NoMotion:
            if not isinstance(task.action, Pick) or task.action.source != TABLE:
                raise
            if not self._uncover(task.action.block, state.table, row):
                raise
        self.study(task.action.block)
        return self._planned(task, state, row)

    def _uncover(self, block: str, loose: Collection[str], row: Performed) -> bool:
        """Set aside what lies on a block, from the top; say whether anything did.

        Raises:
            ExecutionFailure: where it cannot be.
        """
        for _ in loose:
            above = covering(block, loose, self.look().blocks, self.world.tabletop)
            if not above:
                break
            self._set_aside(above[0], row)
            row.aside += [above[0]] if above[0] not in row.aside else []
        return bool(row.aside)

    def _set_aside(self, block: str, row: Performed) -> None:
        """Pick a block that lies on others, and put it down beside them, in the table region.

        Raises:
            ExecutionFailure: where it cannot be picked, or there is no place for it.
        """
        hand, arm = self.grounder.pick_and_place, self.grounder.arm
        try:
            self.study(block)
        except Blind as failure:
            raise NoMotion(str(failure)) from None
        where = self.look()
        pose = where.blocks[block]
        if not free_places(self.world.tabletop, where, block):
            raise NoMotion(f"no room in the table region to set block {block!r} aside")
        with _counted(row):
            segments, grasp = hand.pick(self.world.commanded(), block, pose, arm.around(where))
        follow(self.world, segments)
        self._require_grasp(block, grasp)
        self.hand, self.grasp = block, grasp
        where = self.look()
        with _counted(row):
            segments = self._put_down(block, pose.yaw, where)
        follow(self.world, segments)
        self.hand = None
        self.world.wait(PAUSE)
        self.world.settle()

    def _put_down(self, block: str, yaw: float, where: Geometry) -> list[Segment]:
        """Plan to put the held block into the table region, at the nearest place that the arm comes to.

        Raises:
            NoMotion: where there is none.
        """
        hand, arm, joints = self.grounder.pick_and_place, self.grounder.arm, self.world.commanded()
        scene, middle = arm.around(where), arm.height(block, where) / 2
        for x, y in free_places(self.world.tabletop, where, block)[:PLACES]:
            try:
                way = hand.landing(joints, block, standing(x, y, middle, yaw), scene, self.grasp)
                return hand.place(joints, block, way, scene)
            except ExecutionFailure:
                continue
        raise NoMotion(f"no room in the table region to set block {block!r} aside")

    def _planned(self, task: Task, state: State, row: Performed) -> Task:
        """Plan an action online and add the time that it takes to the record."""
        with _counted(row):
            return self._plan_online(task, state)

    def _plan_online(self, task: Task, state: State) -> Task:
        """Plan an action from the observed scene and the arm's present state."""
        where, joints = self.look(), self.world.commanded()
        problem: ExecutionFailure | None = None
        for approach in self._ways_down(task, where):
            try:
                return self.grounder.task(task.action, state, where, joints, approach, self.grasp)
            except ExecutionFailure as failure:
                problem = problem or failure
        assert problem is not None
        if isinstance(problem, NoIk) and isinstance(task.action, Pick) and task.action.source == TABLE:
            raise OutOfReach(f"block {task.action.block!r}: {problem}") from None
        raise problem

    def _ways_down(self, task: Task, where: Geometry) -> list[Approach | None]:
        """The promised way down of a place where it is free, and None for a new one; the best first.

        The open pipeline takes the promised one without looking.
        """
        promised = task.approach
        if promised is None or promised.grasp != self.grasp:
            return [None]
        if not self.policy.repair or not isinstance(task.action, Place):
            return [promised, None]
        hand, block = self.grounder.pick_and_place, task.action.block
        scene = self.grounder.arm.scene(where.blocks, where.carriers)
        if hand.still_free(promised, block, scene):
            return [promised, None]
        return [None, promised] if hand.still_free(promised, block, scene, SCENE_ALLOWANCE) else [None]

    def _usable(self, task: Task, state: State) -> bool:
        """Whether a motion planned earlier begins as the arm is now, and fits the scene (if the policy looks at it)."""
        moves = [segment for segment in task.segments or () if isinstance(segment, Move)]
        if moves and np.abs(moves[0].path.start - self.world.commanded()).max() > 1e-6:
            return False
        if task.approach is not None and task.approach.grasp != self.grasp:
            return False
        if not self.policy.repair:
            return True
        where = self.look()
        anchor = self.grounder.anchor(task.action, state, where)
        if anchor is not None and task.anchor is not None and hypot(*(anchor - task.anchor)[:2]) > MOVED:
            return False
        scene = self.grounder.arm.scene(where.blocks, where.carriers)
        return all(move.free(scene, SCENE_ALLOWANCE) for move in moves)

    def _require_grasp(self, block: str, grasp: Grasp) -> None:
        """Raise `Slip`, the hand opened, unless the block is between the fingers."""
        away = float(np.linalg.norm(self.look().blocks[block].position - self.world.tool_position()))
        holds = self.world.fingers().mean() > HELD_OPENING * grasp.width
        if away < GRASPED_WITHIN * self.world.tabletop.size(block).footprint if self.sight.exact else holds:
            return
        self.world.grip(self.grounder.arm.opening(grasp.width), OPEN_SECONDS)
        raise Slip(f"block {block!r} is {away * 100:.1f} cm from the fingers after the grasp")


@contextmanager
def _counted(row: Performed) -> Iterator[None]:
    """Add what planning online takes to an action's times."""
    watch = Stopwatch()
    try:
        with watch:
            yield
    finally:
        row.times.online += watch.wall
        row.times.online_cpu += watch.cpu


def _stands_on(block: str, target: str, state: State) -> bool:
    return state.piles[target][-1:] == [block] if target in state.piles else block in state.carried[target]


def follow(world: World, segments: Sequence[Segment]) -> None:
    """Let the simulated arm and fingers do what was planned."""
    for segment in segments:
        if isinstance(segment, Grip):
            world.grip(segment.opening, segment.seconds)
        else:
            world.meant = segment.ignored
            world.follow(segment.trajectory, segment.opening)
            world.wait(PAUSE)
