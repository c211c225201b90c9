"""How fast, how straight, how safe: `python -m smash.execution.motion_benchmark` prints the figures of docs/motion.md.

Random picks, places and topple pushes: three stack places and twelve buffers, random piles, some blocks lying about.
Times are CPU time of this process, the check against the hulls included, the compilation of the kernels left out.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from time import process_time

import numpy as np

from smash.execution.collision import CollisionChecker
from smash.execution.errors import ExecutionFailure
from smash.execution.hulls import HullChecker
from smash.execution.kinematics import inverse
from smash.execution.motion import MotionPlanner
from smash.execution.paths import Path
from smash.execution.poses import ToolPose, Vector, top_down, yaw_rotation
from smash.execution.robot import LOWER, READY, UPPER
from smash.execution.scene import Attached, HandState, Scene
from smash.execution.timing import FREE, Pace, Trajectory, time_path, topple_pace

SIDE = 0.045
STACKS = ((0.45, -100.0), (0.45, -30.0), (0.45, 40.0))
BUFFERS = (
    *((0.42, angle) for angle in np.arange(102.0, 159.0, 14.0)),
    *((0.58, angle) for angle in np.arange(102.0, 163.0, 10.0)),
)
OPEN = HandState(SIDE / 2 + 0.01)
CLOSED = HandState()
LIFT = (0.0, 0.0, 0.10)
RUN_UP = 0.10


@dataclass
class Tally:
    """What the benchmark saw.

    Attributes:
        seconds: CPU seconds by kind of work [s].
        kinds: How many free motions were straight, how many needed a tree.
        failures: By name.
        trajectories: Those of all motions, with the scene and the hand they were planned for.
    """

    seconds: dict[str, list[float]] = field(default_factory=dict)
    kinds: Counter[str] = field(default_factory=Counter)
    failures: Counter[str] = field(default_factory=Counter)
    trajectories: list[tuple[Trajectory, Scene, HandState]] = field(default_factory=list)

    def add(self, what: str, begun: float) -> None:
        """Count the CPU time since `begun`."""
        self.seconds.setdefault(what, []).append(process_time() - begun)


@dataclass(frozen=True)
class Table:
    """Piles on their places and blocks that lie flat, as names, and all of them as a scene."""

    piles: tuple[tuple[str, ...], ...]
    lying: tuple[str, ...]
    scene: Scene

    def pose(self, block: str, turn: int) -> ToolPose:
        """Grasp of a block at its middle, with one of its four yaws."""
        index = self.scene.names.index(block)
        axis = self.scene.rotations[index][:, 0]
        return top_down(self.scene.centres[index], float(np.arctan2(axis[1], axis[0])) + turn * np.pi / 2)


def random_table(generator: np.random.Generator, blocks: int) -> Table:
    """Blocks on random places, up to a third of them lying where a topple could have left them."""
    places = (*STACKS, *BUFFERS)
    piles: list[list[str]] = [[] for _ in places]
    names: list[str] = []
    centres: list[Vector] = []
    rotations: list[Vector] = []
    lying: list[str] = []
    fallen = int(generator.integers(0, blocks // 3 + 1))
    for number in range(blocks):
        name = f"b{number}"
        if number < fallen:
            angle, radius = np.deg2rad(generator.uniform(-80.0, 20.0)), generator.uniform(0.33, 0.62)
            middle = np.array([radius * np.cos(angle), radius * np.sin(angle), SIDE / 2])
            if any(np.linalg.norm(middle[:2] - other[:2]) < 1.6 * SIDE for other in centres):
                continue
            lying.append(name)
            turn = generator.uniform(-np.pi, np.pi)
        else:
            place = int(generator.choice(len(STACKS)) if generator.random() < 0.7 else generator.choice(len(places)))
            radius, turn = places[place][0], np.deg2rad(places[place][1])
            height = SIDE * (len(piles[place]) + 0.5)
            middle = np.array([radius * np.cos(turn), radius * np.sin(turn), height])
            if any(np.linalg.norm(middle - other) < 1.6 * SIDE for other in centres[: len(lying)]):
                continue
            piles[place].append(name)
        names.append(name)
        centres.append(middle)
        rotations.append(yaw_rotation(float(turn)))
    scene = Scene.of_boxes(names, np.array(centres), SIDE / 2, np.array(rotations)).with_table()
    return Table(tuple(tuple(pile) for pile in piles), tuple(lying), scene)


def run(tables: int, blocks: int, seed: int) -> Tally:
    """Plan a pick, a place and a topple push on each of so many random tables."""
    tally, planner = Tally(), MotionPlanner(seed=seed)
    for number in range(tables):
        generator = np.random.default_rng([seed, number])
        table = random_table(generator, blocks)
        try:
            _pick_and_place(table, generator, planner, tally)
            _push(table, generator, planner, tally)
        except ExecutionFailure as failure:
            tally.failures[failure.failure] += 1
    return tally


def _pick_and_place(table: Table, generator: np.random.Generator, planner: MotionPlanner, tally: Tally) -> None:
    takable = [*table.lying, *(pile[-1] for pile in table.piles if pile)]
    block = str(generator.choice(takable))
    target = int(generator.choice([place for place, pile in enumerate(table.piles) if not pile or pile[-1] != block]))
    rest = table.scene.without([block])
    grasps = [table.pose(block, turn) for turn in (0, 1, 2, 3)]
    grasped = _reach(READY, grasps, table.scene, rest, OPEN, planner, tally)
    held = HandState(SIDE / 2, Attached.cube(SIDE))
    lifted = _line(grasped, LIFT, rest, held, planner, tally)
    radius, angle = (*STACKS, *BUFFERS)[target]
    height = SIDE * (len(table.piles[target]) + 0.5) + 0.001
    spot = np.array([radius * np.cos(np.deg2rad(angle)), radius * np.sin(np.deg2rad(angle)), height])
    places = [top_down(spot, np.deg2rad(angle) + turn * np.pi / 2) for turn in range(4)]
    _reach(lifted, places, rest, rest, held, planner, tally)


def _push(table: Table, generator: np.random.Generator, planner: MotionPlanner, tally: Tally) -> None:
    stacks = [place for place in range(len(STACKS)) if table.piles[place]]
    if not stacks:
        return
    place = int(generator.choice(stacks))
    pile = table.piles[place]
    cut = int(generator.integers(len(pile)))
    radius, angle = STACKS[place][0], np.deg2rad(STACKS[place][1])
    along = np.array([-np.sin(angle), np.cos(angle), 0.0])
    middle = np.array([radius * np.cos(angle), radius * np.sin(angle), SIDE * (cut + 0.2) + 0.0072])
    before = middle - (SIDE / 2 + 0.032 + RUN_UP) * along
    poses = [top_down(before, float(angle) + turn) for turn in (np.pi / 2, -np.pi / 2)]
    ready = _reach(READY, poses, table.scene, table.scene, CLOSED, planner, tally)
    rest = table.scene.without(pile[cut:])
    _line(ready, (RUN_UP + 1.1 * SIDE) * along, rest, CLOSED, planner, tally, topple_pace(len(pile) - cut))


def _reach(
    start: Vector,
    poses: Sequence[ToolPose],
    scene: Scene,
    near: Scene,
    hand: HandState,
    planner: MotionPlanner,
    tally: Tally,
) -> Vector:
    begun = process_time()
    reach = planner.reach(start, poses, scene, hand=hand, contact_scene=near, back=LIFT)
    tally.add("reach (grasp, line and free motion)", begun)
    _free(start, reach.transfer.end, scene, hand, planner, tally)
    _time(reach.approach, near, hand, tally)
    return reach.approach.end


def _free(start: Vector, goal: Vector, scene: Scene, hand: HandState, planner: MotionPlanner, tally: Tally) -> None:
    begun = process_time()
    path = planner.plan(start, goal, scene, hand=hand)
    tally.add("free motion", begun)
    tally.seconds.setdefault(f"free motion, {path.kind}", []).append(tally.seconds["free motion"][-1])
    tally.kinds[path.kind] += 1
    _time(path, scene, hand, tally)


def _line(
    start: Vector,
    offset: Iterable[float],
    scene: Scene,
    hand: HandState,
    planner: MotionPlanner,
    tally: Tally,
    pace: Pace = FREE,
) -> Vector:
    begun = process_time()
    path = planner.line(start, tuple(offset), scene, hand=hand)
    tally.add("line", begun)
    _time(path, scene, hand, tally, pace)
    return path.end


def _time(path: Path, scene: Scene, hand: HandState, tally: Tally, pace: Pace = FREE) -> None:
    begun = process_time()
    trajectory = time_path(path, pace)
    tally.add("time parameterisation", begun)
    tally.trajectories.append((trajectory, scene, hand))


def touching(tally: Tally, step: float = 0.01) -> int:
    """How many of the timed trajectories touch something, asked of the hulls every `step` [s]."""
    return sum(
        HullChecker(scene, hand, 0.003).contact(trajectory.sample(step)) is not None
        for trajectory, scene, hand in tally.trajectories
    )


def compare_checkers(states: int, seed: int) -> Counter[tuple[bool, bool]]:
    """(free by the spheres, free by the hulls) of random configurations on a random table, a block in the hand."""
    generator = np.random.default_rng(seed)
    table = random_table(generator, 9)
    held = HandState(SIDE / 2, Attached.cube(SIDE))
    fast, exact = CollisionChecker(table.scene, held, 0.0), HullChecker(table.scene, held, 0.0)
    verdicts: Counter[tuple[bool, bool]] = Counter()
    for joints in generator.uniform(LOWER, UPPER, (states, 7)):
        verdicts[fast.free(joints), exact.contact(joints) is None] += 1
    return verdicts


def solve_targets(count: int, seed: int) -> tuple[int, list[float]]:
    """How many of so many random top-down targets in reach have a solution, and the CPU times [s]."""
    generator = np.random.default_rng(seed)
    solved, seconds = 0, []
    for _ in range(count):
        radius, angle = generator.uniform(0.30, 0.65), generator.uniform(-2.8, 2.8)
        point = [radius * np.cos(angle), radius * np.sin(angle), generator.uniform(0.02, 0.42)]
        pose = top_down(point, generator.uniform(-np.pi, np.pi))
        begun = process_time()
        solved += bool(inverse(pose))
        seconds.append(process_time() - begun)
    return solved, seconds


def table_of(seconds: dict[str, list[float]]) -> str:
    """A Markdown table: count, median, 95th percentile and greatest [ms]."""
    rows = ["| | count | median [ms] | p95 [ms] | greatest [ms] |", "| --- | ---: | ---: | ---: | ---: |"]
    for what, values in seconds.items():
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
    print(f"Timed trajectories that touch something: {touching(tally)} of {len(tally.trajectories)}.")
    verdicts = compare_checkers(options.states, options.seed)
    print(
        f"{options.states} random states: {verdicts[True, True]} free by both, {verdicts[False, False]} blocked by "
        f"both, {verdicts[False, True]} false alarms of the spheres, {verdicts[True, False]} missed by the spheres."
    )


if __name__ == "__main__":
    main()
