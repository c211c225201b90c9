"""When the actions of a plan happen on the gadget: steps counted by hand."""

import pytest

from smash.gadget.library import gadget_of
from smash.gadget.schedule import Event, Scheduler
from smash.problem import IllegalAction, Lift, Pick, Place, PositionsGoal, Topple, make_instance


def piles(capacities=None, **start):
    return make_instance(
        name="piles",
        blocks=[block for pile in start.values() for block in pile],
        stacks=["s1", "s2", "s3", "s4"],
        start=start,
        goal=PositionsGoal({}),
        capacities=capacities or {},
    )


def schedule(instance, *actions):
    return Scheduler(gadget_of(instance), instance).run(actions)


def moved(block, source, target):
    return Pick(block, source), Place(block, target)


def test_a_block_rises_to_the_top_node_before_it_leaves():
    """Four blocks, so four nodes a location: a block at height 2 rises by 2, and enters the other pile at once."""
    found = schedule(piles(s1="ab", s2="cd"), *moved("b", "s1", "s3"))
    assert found.events["s1"] == [Event(2, ("b",), push=False)]
    assert found.events["s3"] == [Event(2, ("b",), push=True)]


def test_moves_between_different_locations_share_a_step_and_moves_of_one_location_do_not():
    instance = piles(s1="ab", s2="cd")
    apart = schedule(instance, *moved("b", "s1", "s3"), *moved("d", "s2", "s4"))
    assert apart.events["s1"][0].step == apart.events["s2"][0].step == 2
    shared = schedule(instance, *moved("b", "s1", "s3"), *moved("d", "s2", "s3"))
    assert [event.step for event in shared.events["s3"]] == [2, 3]


def test_toppled_blocks_are_staged_one_a_step_fall_at_once_and_can_then_be_picked():
    """Block b leaves at step 1 (height 2 of 3), a at 2, both fall at 3, v_T^i is left at 5 at the earliest."""
    found = schedule(piles(s1="ab", s2="c"), Topple("s1", 1), *moved("a", "table", "s3"))
    assert [(event.step, event.blocks) for event in found.events["s1"]] == [(1, ("b",)), (2, ("a",))]
    assert list(found.active) == [3]
    assert found.events["s3"] == [Event(5, ("a",), push=True)]


def test_a_lift_moves_its_blocks_in_one_step_once_the_other_pile_has_sunk():
    found = schedule(piles({"lift": 2}, s1="ab", s2="c"), Lift("s1", 1, "s2"))
    (leave,), (enter,) = found.events["s1"], found.events["s2"]
    assert leave.step == enter.step
    assert leave.blocks == enter.blocks == ("a", "b")


def test_a_block_put_back_where_it_was_moves_nowhere():
    found = schedule(piles(s1="ab"), *moved("b", "s1", "s1"))
    assert not any(found.events.values())


@pytest.mark.parametrize(
    ("actions", "reason"),
    [
        (moved("a", "s1", "s2"), "the top of 's1'"),
        ((Topple("s2", 1),), "no block falls"),
        ((Pick("b", "s1"),), "ends with 'b' in the hand"),
    ],
)
def test_what_the_law_refuses_is_not_scheduled(actions, reason):
    with pytest.raises(IllegalAction, match=reason):
        schedule(piles(s1="ab"), *actions)
