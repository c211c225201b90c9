"""A draft is followed by the law: what it refuses is not in it."""

import pytest

from smash.planners.layered.draft import Draft
from smash.problem import IllegalAction, Pick, Place, Topple
from smash.problem.model import TABLE
from tests.planners.layered.made import NO_TOPPLE, reversal


def test_the_state_follows_the_actions():
    draft = Draft(reversal())
    draft.add(Topple("s", 1))
    draft.move("b", TABLE, "s")
    assert draft.state.piles["s"] == ["b"]
    assert (draft.place_of("a"), draft.place_of("b")) == (TABLE, "s")
    assert draft.actions == (Topple("s", 1), Pick("b", TABLE), Place("b", "s"))


def test_a_topple_of_which_nothing_would_fall_is_left_out():
    draft = Draft(reversal())
    draft.add(Topple("s", 3), Topple("s", 2), Topple("s", 2))
    assert draft.actions == (Topple("s", 2),)


def test_what_the_law_refuses_is_refused():
    with pytest.raises(IllegalAction):
        Draft(reversal()).move("a", "s", "u")
    with pytest.raises(IllegalAction):
        Draft(reversal(options=NO_TOPPLE)).add(Topple("s", 1))
