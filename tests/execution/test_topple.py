import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from smash.execution.actions.arm_motions import ArmMotions
from smash.execution.actions.topple import (
    MOST_CUT,
    MOST_SWEPT,
    PUSH_MARGIN,
    RUN_UP,
    directions,
    first_cut,
    heap,
    manner,
    pushes_needed,
    topple,
)
from smash.execution.scene.block_pose import standing
from smash.execution.scene.scene_file import default_scene
from smash.execution.scene.tabletop import Slot
from smash.motion.move import Move
from tests.robots import PANDA, READY


@given(st.integers(1, 12), st.integers(1, 12))
def test_pushes_from_the_top_take_all_that_shall_fall_and_no_push_too_much(height, falling):
    top = height + falling - 1
    pushes = 0
    while top >= height:
        cut = first_cut(height, top)
        assert height <= cut <= top
        assert top - cut + 1 <= (MOST_SWEPT if cut == 1 else MOST_CUT)
        top = cut - 1
        pushes += 1
    assert pushes <= (3 if height > 1 or falling > MOST_SWEPT else 1)
    assert pushes_needed(height, height + falling - 1) == pushes


def test_the_direction_whose_strip_is_emptier_comes_first():
    slot = Slot(0.45, 0.3, ("counter-clockwise", "clockwise"))
    lying = standing(*slot.point(0.2, 0.0, "counter-clockwise"), 0.0225, 0.0)
    assert directions(slot, 2, [], 0.045) == ["counter-clockwise", "clockwise"]
    assert directions(slot, 2, [lying], 0.045) == ["clockwise", "counter-clockwise"]


MANNERS = [(1, 2, 0.30), (1, 5, 0.15), (1, 9, 0.08), (2, 2, 0.50), (2, 4, 0.60)]


@pytest.mark.parametrize(("height", "falling", "at_contact"), MANNERS)
def test_a_push_meets_the_pile_at_the_speed_that_its_manner_asks_for_as_far_as_the_arm_can(height, falling, at_contact):
    scene = default_scene()
    slot, pile = scene.stacks[1], tuple(f"b{level}" for level in range(height + falling - 1))
    poses = {b: standing(slot.x, slot.y, (level + 0.5) * scene.side, slot.angle) for level, b in enumerate(pile)}
    moves = [move for move in topple(ArmMotions(scene), READY, slot, pile, height, poses) if isinstance(move, Move)]
    push = next(move for move in moves if move.margin == PUSH_MARGIN and move.ignored)
    over = PANDA.forward(moves[-1].path.end).position[2] - PANDA.hand.tip
    assert over > heap(falling) * scene.side
    tool = np.array([PANDA.forward(row).position for row in push.trajectory.sample(1e-3)])
    speeds = np.linalg.norm(np.diff(tool, axis=0), axis=1) / 1e-3
    contact = int(np.searchsorted(np.linalg.norm(tool - tool[0], axis=1), RUN_UP))
    assert speeds[contact] >= 0.98 * at_contact
    assert speeds.max() <= 1.03 * manner(height, falling).speed
