"""Where toppled blocks land, by the height of the cut and the number that fall, and how often all goes well.

The paper's future work: execution feedback for the task layer. A trial topples one pile in a fresh world; it is a
success if everything that should stand still stands, and every toppled block can be grasped where it lies.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import count as counted
from itertools import islice
from pathlib import Path

import msgspec
import numpy as np

from smash.execution.actions.arm_motions import ArmMotions, duration
from smash.execution.actions.pick_and_place import PickAndPlace
from smash.execution.actions.topple import strip
from smash.execution.grounding import Grounder, Task
from smash.execution.performing import Performer
from smash.execution.physics.engines import engine_of, world_of
from smash.execution.policy import OPEN
from smash.execution.readback import read_state
from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.noise import Chance
from smash.execution.scene.start import starting_poses
from smash.execution.scene.tabletop import Slot, Tabletop
from smash.execution.sight import Sight
from smash.execution.trials.estimates import Estimates, Rate
from smash.motion.poses import Vector
from smash.problem.actions.topple import Topple
from smash.problem.errors import ExecutionFailure
from smash.problem.files.documents import replacing
from smash.problem.making import make_instance
from smash.problem.model import PositionsGoal
from smash.problem.rules import Law
from smash.records.episodes import Performed
from smash.records.trials import Landing, Trial


def run_trial(tabletop: Tabletop, stack: int, height: int, falling: int, seed: int, engine: str | None = None) -> Trial:
    """Topple `falling` blocks from `height` upward off one of the scene's stacks.

    Args:
        tabletop: The scene.
        stack: Index of the stack.
        height: Lowest level that falls, 1 is the bottom.
        falling: Number of blocks that fall.
        seed: Of the start poses.
        engine: What simulates it; the scene's, or the one that is there, where none is named.
    """
    engine = engine_of(tabletop, engine)
    names = pile_of(tabletop, height + falling - 1, seed)
    location, slot = f"s{stack}", tabletop.stacks[stack]
    instance = make_instance(
        name="trial", blocks=names, stacks=[location], start={location: names}, goal=PositionsGoal({})
    )
    slots = {location: slot}
    chance = Chance(tabletop, instance, seed)
    poses = chance.at_start(starting_poses(instance, slots, tabletop, np.random.default_rng(seed)))
    arm = ArmMotions(tabletop, seed)
    action = Topple(location, height)
    blank = Trial(
        scene=tabletop.name,
        layout=tabletop.fingerprint,
        engine=engine,
        robot=arm.robot.label,
        stack=stack,
        height=height,
        falling=falling,
        seed=seed,
    )
    with world_of(engine)(chance.scene(), poses, arm.robot.ready, made=chance.made) as world:
        world.settle()
        before, begun = world.poses(), world.time
        performer = Performer(world, Grounder(arm), Geometry(slots), OPEN, Sight(world, chance))
        try:
            performer.perform(Task(action, None), Performed(step=1, action=[], origin="plan"), performer.observe())
        except ExecutionFailure as failure:
            return msgspec.structs.replace(blank, problem=str(failure))
        after, joints, seconds = world.poses(), world.commanded(), world.time - begun
    *_, expected = Law(instance).states([action])
    lower = expected.piles[location]
    return msgspec.structs.replace(
        blank,
        moved=max((float(np.linalg.norm(after[b].position - before[b].position)) for b in lower), default=0.0),
        stands=read_state(Geometry(slots, blocks=after), tabletop).piles[location] == lower,
        landings=tuple(
            _landing(arm, slot, level, block, after, joints)
            for level, block in enumerate(names, start=1)
            if block in expected.table
        ),
        seconds=seconds,
    )


def pile_of(tabletop: Tabletop, count: int, seed: int) -> list[str]:
    """Names for a pile of so many blocks: where a scene has sizes by name, some of those blocks in a drawn order."""
    named = list(tabletop.sizes)
    if not named:
        return [f"b{level}" for level in range(1, count + 1)]
    drawn = np.random.default_rng([seed, count]).permutation(len(named))[:count]
    others = (f"b{number}" for number in counted(1) if f"b{number}" not in tabletop.sizes)
    return [named[number] for number in drawn] + list(islice(others, count - len(drawn)))


def _landing(
    arm: ArmMotions, slot: Slot, level: int, block: str, poses: Mapping[str, BlockPose], joints: Vector
) -> Landing:
    position = poses[block].position
    along, aside = slot.coordinates(float(position[0]), float(position[1]), slot.directions[0])
    try:
        segments, _ = PickAndPlace(arm).pick(joints, block, poses[block], arm.scene(poses))
    except ExecutionFailure:
        return Landing(level, along, aside, False)
    return Landing(level, along, aside, True, duration(segments))


def estimates(scene: str, trials: Iterable[Trial]) -> Estimates:
    """Success rates by height of the cut and number of falling blocks."""
    counts: dict[int, dict[int, Rate]] = {}
    for trial in trials:
        by_size = counts.setdefault(trial.height, {})
        known = by_size.get(trial.falling)
        good, total = (0, 0) if known is None else (known.successes, known.trials)
        by_size[trial.falling] = Rate(good + trial.success, total + 1)
    return Estimates.of(scene, counts)


def draw(trials: Sequence[Trial], path: Path) -> None:
    """Plot where blocks landed: a row per number of falling blocks, a column per height of the cut; 7 inches wide."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.patches import Rectangle

    heights, sizes = sorted({t.height for t in trials}), sorted({t.falling for t in trials})
    figure = Figure(figsize=(7.0, 0.62 * len(sizes) + 1.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(len(sizes), len(heights), squeeze=False, sharex=True, sharey=True)
    for row, size in enumerate(sizes):
        for column, height in enumerate(heights):
            axis, area = axes[row][column], strip(size)
            part = [t for t in trials if (t.height, t.falling) == (height, size)]
            corner = (0.0, -100 * area.half_width)
            axis.add_patch(Rectangle(corner, 100 * area.length, 200 * area.half_width, color="#d9822b", alpha=0.15))
            axis.plot(0, 0, "s", color="#2563a8", markersize=4)
            for graspable, colour, marker in ((True, "#2f7d4f", "o"), (False, "#c0392b", "x")):
                points = [p for t in part for p in t.landings if p.graspable == graspable]
                axis.scatter(
                    [100 * p.along for p in points], [100 * p.aside for p in points], s=7, c=colour, marker=marker
                )
            good = f"{sum(t.success for t in part)} of {len(part)}" if part else "not tried"
            axis.text(0.98, 0.94, good, transform=axis.transAxes, ha="right", va="top", fontsize=7)
            axis.tick_params(labelsize=7)
            if row == 0:
                axis.set_title(f"cut at {height}", fontsize=9)
            if column == 0:
                axis.set_ylabel(f"{size} fall{'' if size > 1 else 's'}", fontsize=8)
            if row == len(sizes) - 1:
                axis.set_xlabel("along the push [cm]", fontsize=8)
    # The second of several pushes may go the other way.
    nearest = min((100 * landing.along for trial in trials for landing in trial.landings), default=0.0)
    axes[0][0].set(xlim=(min(-12.0, nearest - 5), 82), ylim=(-18, 18))
    figure.supylabel("aside [cm]", fontsize=8)
    figure.suptitle(
        "Where toppled blocks come to lie, and how many topples went well\n"
        "red: cannot be grasped from above; shaded: the strip of the first push; square: the pile",
        fontsize=8,
    )
    with replacing(path) as whole:
        figure.savefig(whole, dpi=200)
