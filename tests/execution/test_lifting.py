"""Lifting the upper part of a pile whole: grasps, refusals, and a lift in physics."""

import dataclasses
from math import acos

import numpy as np
import pytest

from smash.execution.actions.arm_motions import ArmMotions
from smash.execution.actions.registry import MOTIONS
from smash.execution.executor import Executor
from smash.execution.policy import OPEN
from smash.execution.readback import read_state
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.scene_file import default_scene
from smash.execution.scene.start import starting_poses
from smash.execution.scene.tabletop import Slot
from smash.motion.errors import NoIk
from smash.motion.move import Move
from smash.problem import Lift, Pick, Place, PositionsGoal, State, make_instance
from smash.problem.errors import ExecutionFailure
from tests.execution.episodes import piles_of, plan_of
from tests.robots import PANDA, READY


def lifted(instance, action, scene=None, **elsewhere):
    scene = scene or default_scene()
    slots = {**scene.bind(instance), **elsewhere}
    where = Geometry(slots, blocks=starting_poses(instance, slots, scene, np.random.default_rng(0)))
    arm, state = ArmMotions(scene), State.start_of(instance)
    segments = MOTIONS[Lift].plan(arm, READY, action, state, where)
    MOTIONS[Lift].foresee(arm, action, state, where)
    return segments, read_state(where, scene)


@pytest.mark.parametrize("height", [1, 2, 3])
def test_a_pile_is_held_at_one_tilt_all_the_way(height):
    segments, after = lifted(piles_of(s1="abcd", s2="e"), Lift("s1", height, "s2"))
    assert after.piles["s2"] == [*"e", *"abcd"[height - 1 :]]
    tilts = [
        acos(-PANDA.forward(joints).rotation[2, 2])
        for segment in segments
        if isinstance(segment, Move) and segment.hand.attached is not None
        for joints in segment.trajectory.sample(0.02)
    ]
    assert max(tilts) - min(tilts) < 0.01


def test_a_pile_out_of_reach_is_a_named_failure():
    with pytest.raises(NoIk, match="block 'a' from the side"):
        lifted(piles_of(s1="ab"), Lift("s1", 1, "s2"), s1=Slot(0.95, 0.5))


def test_a_pile_that_is_walled_in_is_a_named_failure():
    """Blocks twice as high as the fingers are long leave the palm no room, and neighbours leave the hand none."""
    around = tuple(Slot(0.45 + dr, 0.5 + da) for dr, da in ((0.0, 0.2), (0.0, -0.2), (0.09, 0.0), (-0.09, 0.0)))
    scene = default_scene()
    walled = dataclasses.replace(scene, stacks=(Slot(0.45, 0.5), scene.stacks[1], *around))
    instance = make_instance(
        name="walled",
        blocks=[f"{place}{level}" for place in "amwxyz" for level in range(2)],
        stacks=["s", "g", "w", "x", "y", "z"],
        start={
            "s": ["a0", "a1"],
            "g": ["m0", "m1"],
            "w": ["w0", "w1"],
            "x": ["x0", "x1"],
            "y": ["y0", "y1"],
            "z": ["z0", "z1"],
        },
        goal=PositionsGoal({}),
        capacities={"lift": 2},
    )
    with pytest.raises(ExecutionFailure, match="block 'a0'"):
        lifted(instance, Lift("s", 1, "g"), walled)


@pytest.mark.slow
@pytest.mark.parametrize(("height", "seed"), [(1, 0), (2, 1), (3, 2)])
def test_a_lifted_pile_arrives_in_its_order(height, seed):
    instance = piles_of(s1="abcd", s2="e")
    actions = [Lift("s1", height, "s2"), Pick("d", "s2"), Place("d", "s3")]
    episode = Executor(instance, plan_of("piles", *actions), default_scene(), seed=seed, policy=OPEN).run()
    assert episode.success, episode.failure
    assert episode.final.piles["s2"] == [*"e", *"abc"[height - 1 :]]
