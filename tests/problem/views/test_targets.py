"""From a goal of any kind to one pile per location that fulfils it."""

from hypothesis import given, settings

from smash.problem import Law, OnGoal, PositionsGoal, StacksGoal, State, make_instance
from smash.problem.views.numbered import Numbered
from smash.problem.views.targets import Tower, goal_piles, target_piles, towers_of
from tests.strategies import instances


def problem(goal, start=None):
    return Numbered.of(
        make_instance(name="x", blocks="abcd", stacks=["s1", "s2", "s3"], start=start or {"s1": "abcd"}, goal=goal)
    )


@settings(max_examples=150, deadline=None)
@given(instances(max_blocks=5))
def test_the_goal_holds_where_the_target_piles_stand_and_the_rest_lies_on_the_table(instance):
    numbered = Numbered.of(instance)
    piles = target_piles(numbered)
    if piles is None:
        assert len(instance.goal.bottom) > len(instance.locations)
        return
    named = [tuple(instance.blocks[block] for block in pile) for pile in piles]
    listed = [block for pile in named for block in pile]
    assert len(set(listed)) == len(listed)
    state = State(
        {location: list(pile) for location, pile in zip(instance.locations, named, strict=True)},
        set(instance.blocks) - set(listed),
    )
    assert Law(instance).goal_shortfall(state) is None


def test_positions_are_their_piles():
    wanted = goal_piles(problem(PositionsGoal({"a": ("s2", 2), "b": ("s2", 1)})))
    assert wanted == ((), (1, 0), ())


def test_relations_have_no_piles_of_their_own_but_towers():
    numbered = problem(OnGoal({"a": "b", "b": "c"}, ("d", "c")))
    assert goal_piles(numbered) is None
    assert towers_of(numbered) == [Tower((2, 1, 0), grounded=True), Tower((3,), grounded=True)]


def test_a_tower_that_stands_keeps_its_place():
    target = target_piles(problem(OnGoal({"b": "a"}), {"s1": "c", "s2": "abd"}))
    assert target[1][:2] == (0, 1)


def test_a_grounded_tower_goes_where_the_bottom_is_free():
    target = target_piles(problem(OnGoal({}, ("c",)), {"s1": "ab", "s2": "dc"}))
    assert target[2] == (2,)


def test_a_grounded_tower_takes_no_place_of_another():
    target = target_piles(problem(OnGoal({}, ("c", "d")), {"s1": "ac", "s2": "bd"}))
    assert sorted(pile[0] for pile in target if pile)[-2:] == [2, 3]


def test_more_bottoms_than_locations_have_no_target():
    assert target_piles(problem(OnGoal({}, ("a", "b", "c", "d")))) is None


def test_a_whole_arrangement_is_taken_as_it_is():
    goal = StacksGoal({"s3": ("d", "c"), "s1": ("a", "b")})
    assert target_piles(problem(goal)) == ((0, 1), (), (3, 2))
