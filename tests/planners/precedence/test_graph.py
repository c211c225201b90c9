"""The precedence graph: which choices there are, what every plan pays, and the theorems that rest on it."""

import numpy as np
import pytest
from hypothesis import assume, given, settings

from smash.planners.precedence.graph import Choice, build_graph
from smash.problem import OnGoal, PlanOptions, PositionsGoal, StacksGoal, make_instance
from smash.problem.problem import Problem
from tests.oracle import optimal_cost
from tests.planners.precedence.events import cheapest_hitting_cost, freed_by
from tests.strategies import instances, plan_options


def tower(goal, height=3, **more):
    """One stack of `height` blocks, a at the bottom, beside an empty one."""
    blocks = "abcd"[:height]
    return make_instance(name="x", blocks=blocks, stacks=["s1", "s2"], start={"s1": blocks}, goal=goal, **more)


def test_without_a_cap_one_topple_of_the_whole_misplaced_part_is_the_only_choice_of_a_stack():
    graph = build_graph(Problem(tower(StacksGoal({"s1": ("a",), "s2": ("b", "c")})), PlanOptions()))
    assert graph.choices == (Choice("s1", 2, 3, topple=True),)


def test_under_a_cap_the_choices_are_all_runs_of_so_many_neighbours():
    graph = build_graph(Problem(tower(StacksGoal({"s2": ("a", "b", "c")})), PlanOptions(max_topple=2)))
    assert set(graph.choices) == {Choice("s1", 1, 2, topple=True), Choice("s1", 2, 3, topple=True)}


def test_without_topple_each_block_with_a_place_can_be_put_aside():
    graph = build_graph(Problem(tower(StacksGoal({"s2": ("a", "b", "c")})), PlanOptions(topple=False)))
    assert set(graph.choices) == {Choice("s1", height, height, topple=False) for height in (1, 2, 3)}
    assert [choice.cost for choice in graph.choices] == [2, 2, 2]


def test_a_block_that_starts_on_a_buffer_is_put_aside_and_not_toppled():
    instance = make_instance(
        name="x", blocks="a", stacks=["s1"], buffers=["u1"], start={"u1": "a"}, goal=StacksGoal({"s1": ("a",)})
    )
    assert build_graph(Problem(instance, PlanOptions())).choices == (Choice("u1", 1, 1, topple=False),)


def test_blocks_of_the_table_region_are_free_from_the_start():
    instance = make_instance(name="x", blocks="a", stacks=["s1"], start={}, table="a", goal=StacksGoal({"s1": ("a",)}))
    graph = build_graph(Problem(instance, PlanOptions()))
    assert (graph.choices, graph.piles, graph.base_cost) == ((), (), 2)


@pytest.mark.parametrize(("topple", "base", "forced"), [(True, 2, {"b", "c"}), (False, 6, set())])
def test_loose_blocks_above_a_target_fall_together_or_move_one_by_one(topple, base, forced):
    graph = build_graph(Problem(tower(PositionsGoal({"a": ("s2", 1)})), PlanOptions(topple)))
    assert graph.base_cost == base
    assert {graph.blocks[number] for number in graph.must_free} == forced


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=5, kinds=("stacks",)), plan_options())
def test_every_plan_pays_two_for_each_misplaced_block(instance, options):
    misplaced = len(instance.table)
    for location, pile in instance.start.items():
        wanted = instance.goal.stacks.get(location, ())
        right = 0
        while right < min(len(pile), len(wanted)) and pile[right] == wanted[right]:
            right += 1
        misplaced += len(pile) - right
    assert build_graph(Problem(instance, options)).base_cost == 2 * misplaced


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=5), plan_options())
def test_a_blocks_freedom_is_the_sum_of_the_choices_that_free_it(instance, options):
    graph = build_graph(Problem(instance, options))
    values = 2.0 ** np.arange(len(graph.choices))
    expected = np.zeros(len(graph.blocks))
    for choice, value in enumerate(values):
        expected[list(freed_by(graph, [choice]))] += value
    assert (graph.freedom(values) == expected).all()


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=4, kinds=("stacks", "positions"), buffer_start=False), plan_options())
def test_with_topple_and_empty_buffers_the_optimum_is_the_base_and_the_cheapest_hitting_set(instance, options):
    assume(options.topple)
    graph = build_graph(Problem(instance, options))
    assert graph.base_cost + cheapest_hitting_cost(graph) == optimal_cost(instance, options)


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=4), plan_options())
def test_no_plan_is_cheaper_than_the_base_and_the_cheapest_hitting_set(instance, options):
    best = optimal_cost(instance, options)
    assume(best is not None)
    graph = build_graph(Problem(instance, options))
    assert graph.base_cost + cheapest_hitting_cost(graph) <= best


def test_relations_that_hold_already_ask_for_nothing():
    graph = build_graph(Problem(tower(OnGoal({"b": "a", "c": "b"}, ("a",))), PlanOptions()))
    assert (graph.blocks, graph.base_cost) == ((), 0)
