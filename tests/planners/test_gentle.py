"""Gentle topples: the same cost, legal, and no block on the table that could have stayed on its stack."""

from hypothesis import given, settings

from smash.planners.greedy import GreedyPlanner
from smash.planners.protocol import SolveOptions
from smash.planners.protocol.gentle import gentle_topples
from smash.problem import Law, Pick, Place, PositionsGoal, Topple, make_instance
from tests.strategies import instances, plan_options

TOWER = make_instance(
    name="tower",
    blocks=["a", "b", "c"],
    stacks=["s1", "s2"],
    start={"s1": ["a", "b", "c"]},
    goal=PositionsGoal({"a": ("s2", 1)}),
)


def test_a_target_that_can_be_picked_from_its_stack_does_not_fall():
    plan = [Topple("s1", 1), Pick("a", "table"), Place("a", "s2")]
    assert gentle_topples(Law(TOWER), plan) == (Topple("s1", 2), Pick("a", "s1"), Place("a", "s2"))


def test_a_topple_that_nothing_needs_is_left_out():
    plan = [Topple("s1", 3), Pick("c", "table"), Place("c", "s2")]
    assert gentle_topples(Law(TOWER), plan) == (Pick("c", "s1"), Place("c", "s2"))


@settings(max_examples=150, deadline=None)
@given(instances(max_blocks=6, max_stacks=4), plan_options())
def test_a_gentle_plan_is_legal_and_costs_no_more(instance, options):
    plan = GreedyPlanner().solve(instance, SolveOptions(options.topple, options.max_topple), 1.0).actions
    if plan is None:
        return
    gentle = gentle_topples(Law(instance), plan)
    assert Law(instance, options).check(gentle).accepted
    assert len(gentle) <= len(plan)
    assert gentle_topples(Law(instance), gentle) == gentle
