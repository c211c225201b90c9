from math import cos, sin

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from smash.execution.readback import read_state
from smash.execution.scene.block_pose import BlockPose, quarter_turn, standing
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.scene_file import default_scene

SIDE = 0.045
SLOTS = dict(zip(["s1", "s2", "s3"], default_scene().stacks, strict=False))


def pile(location, *blocks, dx=0.0):
    slot = SLOTS[location]
    return {b: standing(slot.x + dx, slot.y, (level + 0.5) * SIDE, slot.angle) for level, b in enumerate(blocks)}


def read(poses, hand=None):
    return read_state(Geometry(SLOTS, blocks=poses), default_scene(), hand)


def test_blocks_on_each_other_are_a_pile():
    state = read({**pile("s2", "b", "a"), **pile("s1", "c")})
    assert state.piles == {"s1": ["c"], "s2": ["b", "a"], "s3": []}
    assert not state.table


def test_a_block_beside_its_location_lies_in_the_table_region():
    state = read(pile("s1", "a", dx=0.02))
    assert state.table == {"a"}


def test_a_leaning_block_stands_nowhere():
    slot = SLOTS["s1"]
    leaning = np.array([[1, 0, 0], [0, cos(0.3), -sin(0.3)], [0, sin(0.3), cos(0.3)]])
    state = read({"a": BlockPose(np.array([slot.x, slot.y, SIDE / 2]), leaning)})
    assert state.table == {"a"}


def test_what_stands_on_a_missing_block_is_no_pile():
    poses = pile("s1", "a", "b", "c")
    poses["b"] = standing(0.3, 0.3, SIDE / 2, 0.0)
    state = read(poses)
    assert state.piles["s1"] == ["a"]
    assert state.table == {"b", "c"}


def test_the_held_block_stands_nowhere():
    state = read(pile("s1", "a", "b"), hand="b")
    assert state.piles["s1"] == ["a"]
    assert state.hand == "b"
    assert not state.table


@settings(deadline=None)
@given(st.permutations("abcdef"), st.integers(0, 6), st.integers(0, 6), st.floats(-0.01, 0.01))
def test_any_arrangement_with_small_errors_is_read_back(order, first, second, error):
    low, high = sorted((first, second))
    piles = {"s1": order[:low], "s2": order[low:high], "s3": order[high:]}
    poses = {}
    for location, blocks in piles.items():
        poses.update(pile(location, *blocks, dx=error))
    state = read(dict(sorted(poses.items())))
    assert state.piles == {location: list(blocks) for location, blocks in piles.items()}


@given(st.floats(-10, 10))
def test_a_cube_looks_the_same_after_a_quarter_turn(yaw):
    pose = standing(0, 0, 0, yaw)
    assert abs(quarter_turn(pose.yaw - yaw)) < 1e-6 or abs(abs(quarter_turn(pose.yaw - yaw)) - np.pi / 4) < 1e-6
