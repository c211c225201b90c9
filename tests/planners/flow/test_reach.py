"""How far a pebble is from its start and its goal: no plan is faster, and nothing is out of reach that a plan uses."""

from hypothesis import given, settings

from smash.gadget import NodeKind
from smash.planners.flow.reach import FAR, reach_of
from smash.planners.flow.scope import scope_of
from smash.planners.flow.warm import motion_of
from smash.problem import PlanOptions, StacksGoal, make_instance
from smash.problem.problem import Problem
from tests.cheapest import cheapest_plan
from tests.strategies import instances, plan_options


def reach_in(instance, block, options=None):
    scope = scope_of(Problem(instance, options or PlanOptions()))
    return scope, reach_of(scope, instance.blocks.index(block))


def tower(goal):
    return make_instance(name="x", blocks="ab", stacks=["s1", "s2"], start={"s1": "ab"}, goal=goal)


def test_a_pebble_is_at_its_start_at_once_and_at_its_goal_with_nothing_to_go():
    scope, reach = reach_in(tower(StacksGoal({"s2": ("b", "a")})), "b")
    assert reach.earliest[scope.start[1]] == 0
    assert reach.togo[scope.goal_of(1)] == 0


def test_the_top_pebble_needs_a_step_up_a_move_and_a_step_down():
    # heights 1 to 2: b stands at height 2 of s1, the top, crosses to the top of s2 and sinks to height 1
    _, reach = reach_in(tower(StacksGoal({"s2": ("b", "a")})), "b")
    assert reach.shortest == 2


def test_the_bottom_pebble_has_to_rise_first():
    _, reach = reach_in(tower(StacksGoal({"s2": ("b", "a")})), "a")
    assert reach.shortest == 2


def test_without_topple_nothing_reaches_the_table_region():
    scope, reach = reach_in(tower(StacksGoal({"s2": ("b", "a")})), "b", PlanOptions(topple=False))
    tables = [number for number, node in enumerate(scope.gadget.nodes) if node.kind is NodeKind.TABLE]
    assert all(reach.earliest[number] == FAR for number in tables)


@settings(max_examples=40, deadline=None)
@given(instances(min_blocks=1, max_blocks=3, max_buffers=1), plan_options())
def test_a_cheapest_plan_keeps_to_what_can_be_reached_when(instance, options):
    best = cheapest_plan(instance, options)
    if best is None or not best[0]:
        return
    scope = scope_of(Problem(instance, options))
    motion = motion_of(Problem(instance, options), scope, best[1])
    for pebble in scope.moving:
        reach = reach_of(scope, pebble)
        assert reach.shortest <= motion.steps
        for layer, nodes in enumerate(motion.layers):
            assert reach.earliest[nodes[pebble]] <= layer
            assert reach.togo[nodes[pebble]] <= motion.steps - layer
