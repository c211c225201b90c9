"""How fast, how straight, how safe: `python -m smash.execution.trials.motion_benchmark` prints the figures.

Random picks, places and topples, planned by what the executor plans them by, in the default scene: piles on stacks and
buffers, some blocks lying about. Times are CPU time of this process, the check against the hulls included, the
compilation of the kernels left out.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from time import process_time
from typing import Any

import numpy as np

from smash.execution.actions.arm_motions import ArmMotions, Segment
from smash.execution.actions.grasps import CENTRED
from smash.execution.actions.topple import topple
from smash.execution.grounding import Grounder
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.scene_file import default_scene
from smash.execution.scene.start import starting_poses
from smash.motion.collision import CollisionChecker
from smash.motion.hulls import HullChecker
from smash.motion.kinematics import inverse
from smash.motion.move import Move
from smash.motion.obstacles import Scene
from smash.motion.paths import Path
from smash.motion.planner import MotionPlanner
from smash.motion.poses import top_down
from smash.motion.robot import Robot
from smash.motion.robots import load_robot
from smash.problem.errors import ExecutionFailure
from smash.problem.making import make_instance
from smash.problem.model import Instance, PositionsGoal, State

TOUCH = 0.003
"""Hulls may enter a box by this much where a motion ends in contact [m]."""


@dataclass
class Tally:
    """What the benchmark saw.

    Attributes:
        seconds: CPU seconds by kind of work [s].
        kinds: How many free motions were straight, how many needed a tree.
        failures: By name.
        moves: All motions, with the scene they were planned in.
    """

    seconds: dict[str, list[float]] = field(default_factory=dict)
    kinds: Counter[str] = field(default_factory=Counter)
    failures: Counter[str] = field(default_factory=Counter)
    moves: list[tuple[Move, Scene]] = field(default_factory=list)

    def add(self, what: str, seconds: float) -> None:
        """Count CPU time [s]."""
        self.seconds.setdefault(what, []).append(seconds)


class TimedPlanner(MotionPlanner):
    """A motion planner that tells a tally what each answer took."""

    def __init__(self, robot: Robot, tally: Tally, seed: int) -> None:
        super().__init__(robot, seed=seed)
        self._tally = tally

    def plan(self, *arguments: Any, **settings: Any) -> Path:
        """Time a free motion."""
        begun = process_time()
        path = super().plan(*arguments, **settings)
        self._tally.add("free motion", process_time() - begun)
        self._tally.add(f"free motion, {path.kind}", process_time() - begun)
        self._tally.kinds[path.kind] += 1
        return path

    def line(self, *arguments: Any, **settings: Any) -> Path:
        """Time a line."""
        begun = process_time()
        path = super().line(*arguments, **settings)
        self._tally.add("line", process_time() - begun)
        return path


def random_table(generator: np.random.Generator, blocks: int) -> tuple[Instance, Geometry]:
    """Blocks in random piles of the default scene, 70 % on stacks; up to a third lie in the table region."""
    scene = default_scene()
    stacks = [f"s{number}" for number in range(len(scene.stacks))]
    buffers = [f"u{number}" for number in range(len(scene.buffers))]
    names = [f"b{number}" for number in range(blocks)]
    lying = int(generator.integers(0, blocks // 3 + 1))
    start: dict[str, list[str]] = {}
    for name in names[lying:]:
        start.setdefault(str(generator.choice(stacks if generator.random() < 0.7 else buffers)), []).append(name)
    instance = make_instance(
        name="random",
        blocks=names,
        stacks=stacks,
        buffers=buffers,
        start=start,
        table=names[:lying],
        goal=PositionsGoal({}),
    )
    slots = scene.bind(instance)
    return instance, Geometry(slots, blocks=starting_poses(instance, slots, scene, generator))


def run(tables: int, blocks: int, seed: int) -> Tally:
    """Plan a pick, a place and a topple on each of so many random tables."""
    tally = Tally()
    arm = ArmMotions(default_scene(), seed)
    arm.planner = TimedPlanner(arm.robot, tally, seed)
    for number in range(tables):
        generator = np.random.default_rng([seed, number])
        instance, where = random_table(generator, blocks)
        for action in (_pick_and_place, _topple):
            try:
                action(arm, instance, where, generator, tally)
            except ExecutionFailure as failure:
                tally.failures[failure.failure] += 1
    return tally


def _pick_and_place(
    arm: ArmMotions, instance: Instance, where: Geometry, generator: np.random.Generator, tally: Tally
) -> None:
    piles = {location: pile for location, pile in instance.start.items() if pile}
    block = str(generator.choice([*instance.table, *(pile[-1] for pile in piles.values())]))
    target = str(generator.choice([q for q in instance.locations if not instance.start[q] or piles[q][-1] != block]))
    grounder, scene = Grounder(arm), arm.scene(where.blocks)
    begun = process_time()
    segments, grasp = grounder.pick_and_place.pick(arm.robot.ready, block, where.blocks[block], scene)
    lifted = _count("pick", begun, segments, scene, tally)
    stand = grounder.stand(target, State.start_of(instance), where)
    begun = process_time()
    way = grounder.pick_and_place.landing(lifted, block, stand, scene, grasp)
    _count("place", begun, grounder.pick_and_place.place(lifted, block, way, scene), scene, tally)


def _topple(arm: ArmMotions, instance: Instance, where: Geometry, generator: np.random.Generator, tally: Tally) -> None:
    stacks = [location for location in instance.stacks if instance.start[location]]
    if not stacks:
        return
    location = str(generator.choice(stacks))
    pile = instance.start[location]
    height = int(generator.integers(1, len(pile) + 1))
    begun = process_time()
    segments = topple(
        arm, arm.robot.ready, where.slots[location], pile, height, where.blocks, None, frozenset(instance.table)
    )
    _count("topple", begun, segments, arm.scene(where.blocks), tally)


def _count(what: str, begun: float, segments: Sequence[Segment], scene: Scene, tally: Tally) -> Any:
    """Count an action's planning and its motions; return where the arm is afterwards [rad], shape (n,)."""
    tally.add(what, process_time() - begun)
    moves = [segment for segment in segments if isinstance(segment, Move)]
    tally.add(f"a motion of a {what}", tally.seconds[what][-1] / len(moves))
    tally.moves += [(move, scene) for move in moves]
    return moves[-1].path.end


def touching(tally: Tally, step: float = 0.01) -> int:
    """How many of the timed motions touch what they should not, asked of the hulls every `step` [s]."""
    return sum(
        HullChecker(move.robot, scene.without(move.ignored), move.hand, TOUCH).contact(move.trajectory.sample(step))
        is not None
        for move, scene in tally.moves
    )


def compare_checkers(states: int, seed: int) -> Counter[tuple[bool, bool]]:
    """(free by the spheres, free by the hulls) of random configurations on a random table, a block in the hand."""
    generator = np.random.default_rng(seed)
    arm = ArmMotions(default_scene())
    robot = arm.robot
    scene, hand = arm.scene(random_table(generator, 9)[1].blocks), CENTRED.hand(arm.side)
    fast, exact = CollisionChecker(robot, scene, hand, 0.0), HullChecker(robot, scene, hand, 0.0)
    verdicts: Counter[tuple[bool, bool]] = Counter()
    for joints in generator.uniform(robot.lower, robot.upper, (states, robot.count)):
        verdicts[fast.free(joints), exact.contact(joints) is None] += 1
    return verdicts


def solve_targets(count: int, seed: int) -> tuple[int, list[float]]:
    """How many of so many random top-down targets in reach have a solution, and the CPU times [s]."""
    generator = np.random.default_rng(seed)
    solved, seconds, robot = 0, [], load_robot()
    for _ in range(count):
        radius, angle = generator.uniform(0.30, 0.65), generator.uniform(-2.8, 2.8)
        point = [radius * np.cos(angle), radius * np.sin(angle), generator.uniform(0.02, 0.42)]
        pose = top_down(point, generator.uniform(-np.pi, np.pi))
        begun = process_time()
        solved += bool(inverse(robot, pose))
        seconds.append(process_time() - begun)
    return solved, seconds


def table_of(seconds: dict[str, list[float]]) -> str:
    """A Markdown table: count, median, 95th percentile and greatest [ms]."""
    rows = ["| | count | median [ms] | p95 [ms] | greatest [ms] |", "| --- | ---: | ---: | ---: | ---: |"]
    for what, values in sorted(seconds.items()):
        milliseconds = np.array(values) * 1000
        cells = [f"{value:.1f}" for value in (*np.percentile(milliseconds, [50, 95]), milliseconds.max())]
        rows.append(f"| {what} | {len(values)} | " + " | ".join(cells) + " |")
    return "\n".join(rows)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tables", type=int, default=200)
    parser.add_argument("--blocks", type=int, default=9)
    parser.add_argument("--states", type=int, default=20000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    run(3, options.blocks, 0)
    tally = run(options.tables, options.blocks, options.seed)
    solved, seconds = solve_targets(100, options.seed)
    tally.seconds["inverse kinematics"] = seconds
    print(table_of(tally.seconds))
    total = sum(tally.kinds.values())
    print(f"\nStraight: {tally.kinds['straight']} of {total} free motions. Failures: {dict(tally.failures) or 'none'}.")
    print(f"Inverse kinematics: {solved} of {len(seconds)} targets.")
    print(f"Timed motions that touch something: {touching(tally)} of {len(tally.moves)}.")
    verdicts = compare_checkers(options.states, options.seed)
    print(
        f"{options.states} random states: {verdicts[True, True]} free by both, {verdicts[False, False]} blocked by "
        f"both, {verdicts[False, True]} false alarms of the spheres, {verdicts[True, False]} missed by the spheres."
    )


if __name__ == "__main__":
    main()
