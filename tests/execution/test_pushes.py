from hypothesis import given
from hypothesis import strategies as st

from smash.execution.pushes import MOST_CUT, MOST_SWEPT, first_cut


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
