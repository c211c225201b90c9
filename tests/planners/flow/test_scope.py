"""Scopes: blocks that never move and buffers that are never needed are left out, and nothing that a plan needs."""

from hypothesis import assume, given, settings

from smash.gadget import NodeKind
from smash.planners.flow.scope import correct_blocks, goal_positions, scope_of
from smash.problem import Carrier, Law, OnGoal, PositionsGoal, StacksGoal, make_instance
from smash.problem.problem import Problem
from tests.oracle import optimal_cost
from tests.strategies import instances, plan_options


def stack(goal, buffers=0, start=None, **more):
    return make_instance(
        name="x",
        blocks="abc",
        stacks=["s1", "s2"],
        buffers=[f"u{number}" for number in range(1, buffers + 1)],
        start=start or {"s1": "abc"},
        goal=goal,
        **more,
    )


def test_blocks_of_the_correct_bottom_part_do_not_move():
    scope = scope_of(Problem(stack(StacksGoal({"s1": ("a", "c", "b")}))))
    assert scope.moving == (1, 2)
    assert scope.fixed_nodes == {scope.gadget.stack_node("s1", 1)}


def test_a_right_block_on_a_wrong_one_moves():
    assert correct_blocks(stack(StacksGoal({"s1": ("b", "a", "c")}))) == frozenset()


def test_buffers_beyond_the_moving_blocks_are_left_out_and_each_block_has_one_of_its_own():
    scope = scope_of(Problem(stack(StacksGoal({"s1": ("a", "c", "b")}), buffers=5)))
    assert scope.instance.buffers == ("u1", "u2")
    assert scope.own_buffer == (None, "u1", "u2")


def test_too_few_buffers_belong_to_nobody():
    scope = scope_of(Problem(stack(StacksGoal({"s1": ("a", "c", "b")}), buffers=1)))
    assert scope.instance.buffers == ("u1",)
    assert not scope.own_buffers


def test_a_buffer_that_a_block_starts_on_is_kept():
    goal = StacksGoal({"s1": ("a", "b", "c")})
    scope = scope_of(Problem(stack(goal, buffers=4, start={"s1": "ab", "u4": "c"})))
    assert scope.moving == (2,)
    assert scope.instance.buffers == ("u1", "u4")


def test_relations_name_no_positions_and_every_block_may_move():
    scope = scope_of(Problem(stack(OnGoal({"b": "a", "c": "b"}), buffers=5)))
    assert goal_positions(scope.instance) == {}
    assert scope.moving == (0, 1, 2)
    assert not scope.own_buffers
    assert not scope.direct


def test_a_base_ends_at_a_bottom_and_what_it_carries_above_one():
    scope = scope_of(Problem(stack(OnGoal({"b": "a"}, ("a",)))))
    heights = [{scope.gadget.nodes[node].key.index for node in scope.final_nodes(pebble)} for pebble in (0, 1)]
    assert heights == [{1}, {2, 3}]


def test_a_listed_block_ends_at_its_position_and_the_others_at_rest():
    scope = scope_of(Problem(stack(PositionsGoal({"a": ("s2", 1)}))))
    assert scope.final_nodes(0) == {scope.gadget.stack_node("s2", 1)}
    kinds = {scope.gadget.nodes[node].kind for node in scope.final_nodes(1)}
    assert {NodeKind.STACK, NodeKind.TABLE} <= kinds
    assert not any(kind.transient for kind in kinds)


def test_tokens_follow_the_blocks_and_end_at_any_station():
    instance = stack(PositionsGoal({"a": ("s2", 1)}), carriers=[Carrier("tray", ("p", "q"), "p", 2)])
    scope = scope_of(Problem(instance))
    assert scope.pebbles == (0, 1, 2, 3)
    assert len(scope.final_nodes(3)) == 2


@settings(max_examples=60, deadline=None)
@given(instances(min_blocks=1, max_blocks=4, max_buffers=2), plan_options())
def test_without_the_idle_buffers_the_optimum_is_the_same(instance, options):
    assume(not Law(instance).check([]).accepted)
    assert optimal_cost(scope_of(Problem(instance, options)).instance, options) == optimal_cost(instance, options)
