"""The law: what each action needs and does, when goals hold."""

import pytest

from smash.problem import (
    IllegalAction,
    Law,
    OnGoal,
    Pick,
    Place,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
    State,
    Topple,
    make_instance,
)


@pytest.fixture
def tower():
    """Return four blocks on s1 with a1 at the bottom, one empty stack, one buffer; a1 must reach the bottom of s2."""
    return make_instance(
        name="tower",
        blocks=["a1", "a2", "a3", "a4"],
        stacks=["s1", "s2"],
        buffers=["u1"],
        start={"s1": ["a1", "a2", "a3", "a4"]},
        goal=PositionsGoal({"a1": ("s2", 1)}),
    )


def test_one_topple_and_one_transfer_reach_a_buried_block(tower):
    plan = [Topple("s1", 2), Pick("a1", "s1"), Place("a1", "s2")]
    assert Law(tower).check(plan).accepted


def test_without_topple_the_same_plan_is_refused_at_its_first_step(tower):
    verdict = Law(tower, PlanOptions(topple=False)).check([Topple("s1", 2)])
    assert (verdict.accepted, verdict.step) == (False, 1)


@pytest.mark.parametrize("order", [["a2", "a3", "a4"], ["a4", "a2", "a3"], ["a3", "a4", "a2"]])
def test_toppled_blocks_can_be_picked_in_any_order(tower, order):
    law, state = Law(tower), State.start_of(tower)
    law.apply(state, Topple("s1", 2))
    for block in order:
        law.apply(state, Pick(block, "table"))
        law.apply(state, Place(block, "s2"))
    assert state.piles["s2"] == order
    assert not state.table


@pytest.mark.parametrize(
    ("actions", "words"),
    [
        ([Pick("a1", "s1")], "top of 's1' is 'a4'"),
        ([Pick("a1", "nowhere")], "no location is called"),
        ([Pick("a1", "table")], "not in the table region"),
        ([Pick("a4", "s2")], "empty"),
        ([Pick("a4", "s1"), Pick("a3", "s1")], "the hand holds"),
        ([Pick("a4", "s1"), Topple("s1", 1)], "the hand holds"),
        ([Pick("a4", "s1"), Place("a4", "table")], "nothing is placed in the table region"),
        ([Pick("a4", "s1"), Place("a3", "s2")], "the hand holds 'a4'"),
        ([Place("a4", "s2")], "the hand is empty"),
        ([Topple("s1", 5)], "no block falls"),
        ([Topple("s1", 0)], "no block falls"),
        ([Topple("s2", 1)], "no block falls"),
        ([Topple("u1", 1)], "buffers are not toppled"),
        ([Topple("x", 1)], "no location is called"),
        ([Topple("s1", 2)], "3 blocks fall, max_topple is 2"),
    ],
)
def test_the_law_refuses_with_a_reason(tower, actions, words):
    law, state = Law(tower, PlanOptions(max_topple=2)), State.start_of(tower)
    for action in actions[:-1]:
        law.apply(state, action)
    before = state.key()
    with pytest.raises(IllegalAction, match=words):
        law.apply(state, actions[-1])
    assert state.key() == before


def test_legal_actions_are_those_that_the_law_does_not_refuse(tower):
    law, state = Law(tower, PlanOptions(max_topple=2)), State.start_of(tower)
    assert set(law.legal_actions(state)) == {Pick("a4", "s1"), Topple("s1", 4), Topple("s1", 3)}


def test_a_held_block_at_the_end_is_not_a_goal(tower):
    assert "hand" in Law(tower).check([Topple("s1", 2), Pick("a1", "s1")]).reason


def test_a_stacks_goal_wants_all_else_empty(tower):
    goal = StacksGoal({"s1": ("a1", "a2", "a3", "a4")})
    instance = make_instance(
        name="x", blocks=tower.blocks, stacks=["s1"], buffers=["u1"], start={"s1": tower.blocks}, goal=goal
    )
    assert Law(instance).check([]).accepted
    assert "holds" in Law(instance).check([Pick("a4", "s1"), Place("a4", "u1")]).reason
    assert "holds" in Law(instance).check([Topple("s1", 4)]).reason


def test_an_on_goal_holds_at_any_location_but_not_on_the_table():
    instance = make_instance(
        name="x",
        blocks=["a", "b", "c"],
        stacks=["s1"],
        buffers=["u1"],
        start={"s1": ["a", "b"]},
        table=["c"],
        goal=OnGoal({"b": "a"}, ("c",)),
    )
    law = Law(instance)
    assert "bottom" in law.check([]).reason
    assert law.check([Pick("c", "table"), Place("c", "u1")]).accepted
    assert not law.check([Pick("c", "table"), Place("c", "s1")]).accepted
