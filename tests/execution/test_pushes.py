from hypothesis import given
from hypothesis import strategies as st

from smash.execution.block_pose import standing
from smash.execution.pushes import MOST_CUT, MOST_SWEPT, directions, first_cut, pushes_needed
from smash.execution.tabletop import Slot


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
    assert pushes <= 3
    assert pushes_needed(height, height + falling - 1) == pushes


def test_the_direction_whose_strip_is_emptier_comes_first():
    slot = Slot(0.45, 0.3, ("counter-clockwise", "clockwise"))
    lying = standing(*slot.point(0.2, 0.0, "counter-clockwise"), 0.0225, 0.0)
    assert directions(slot, 2, [], 0.045) == ["counter-clockwise", "clockwise"]
    assert directions(slot, 2, [lying], 0.045) == ["clockwise", "counter-clockwise"]
