"""Names and numbers: an instance by number, and steps back as actions."""

from hypothesis import given, settings

from smash.problem import TABLE, Pick, Place, PositionsGoal, Topple, make_instance
from smash.problem.views.numbered import ON_TABLE, TOPPLE, Numbered, cost_of
from tests.strategies import instances


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=6, odd_names=True))
def test_numbers_lead_back_to_the_names(instance):
    problem = Numbered.of(instance)
    assert problem.stacks == len(instance.stacks)
    assert problem.locations == len(instance.locations)
    assert problem.blocks == len(instance.blocks)
    for location, pile in zip(instance.locations, problem.start, strict=True):
        assert tuple(instance.blocks[block] for block in pile) == instance.start[location]
    assert tuple(instance.blocks[block] for block in problem.table) == instance.table


def test_a_transfer_is_a_pick_and_a_place_and_a_topple_is_cut_at_its_height():
    problem = Numbered.of(
        make_instance(
            name="x", blocks="abc", stacks=["s1", "s2"], buffers=["u1"], start={"s1": "abc"}, goal=PositionsGoal({})
        )
    )
    steps = [(2, 0, 2), (TOPPLE, 0, 1), (1, ON_TABLE, 1), (TOPPLE, 0, 1)]
    assert problem.actions(steps) == (
        Pick("c", "s1"),
        Place("c", "u1"),
        Topple("s1", 2),
        Pick("b", TABLE),
        Place("b", "s2"),
        Topple("s1", 1),
    )
    assert cost_of(steps) == len(problem.actions(steps)) == 6
