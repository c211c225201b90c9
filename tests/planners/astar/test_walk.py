"""From moves between kinds of places to steps between locations."""

from smash.planners.astar.task import TOPPLED
from smash.planners.astar.walk import Walk
from smash.problem import PositionsGoal, make_instance
from smash.problem.views.numbered import ON_TABLE, TOPPLE, Numbered

FLOOR = 3
"""What a move says for the floor of the first kind of locations, with three blocks."""


def walk(class_of=(0, 0, 1)):
    instance = make_instance(
        name="x", blocks="abc", stacks=["s1", "s2"], buffers=["u1"], start={"s1": "abc"}, goal=PositionsGoal({})
    )
    return Walk(Numbered.of(instance), list(class_of))


def test_a_floor_is_that_of_the_first_free_location_of_its_kind():
    walked = walk()
    walked.move(2, FLOOR)
    walked.move(1, FLOOR + 1)
    assert walked.steps == [(2, 0, 1), (1, 0, 2)]


def test_a_block_goes_on_the_pile_of_the_block_below_it():
    walked = walk()
    walked.move(2, FLOOR + 1)
    walked.move(1, 2)
    assert walked.steps == [(2, 0, 2), (1, 0, 2)]


def test_all_from_the_named_block_up_falls_and_is_picked_from_the_table():
    walked = walk()
    walked.move(1, TOPPLED)
    walked.move(1, FLOOR)
    walked.move(2, 0)
    assert walked.steps == [(TOPPLE, 0, 2), (1, ON_TABLE, 1), (2, ON_TABLE, 0)]


def test_a_location_that_was_emptied_is_free_again():
    walked = walk((0, 0, 0))
    walked.move(0, TOPPLED)
    walked.move(2, FLOOR)
    assert walked.steps[-1] == (2, ON_TABLE, 0)
