"""The arcs of the time-expanded graph: as many as were counted, each of use, and all that a plan needs."""

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from smash.planners.flow.arcs import WAIT, arcs_of, count_arcs, reaches_of
from smash.planners.flow.scope import scope_of
from smash.planners.flow.warm import motion_of
from smash.problem import Law, PlanOptions, StacksGoal, make_instance
from smash.problem.problem import Problem
from tests.cheapest import cheapest_plan
from tests.strategies import instances, plan_options


@settings(max_examples=60, deadline=None)
@given(instances(min_blocks=1, max_blocks=4), plan_options(), st.integers(0, 12))
def test_there_are_as_many_arcs_as_were_counted_and_no_two_are_alike(instance, options, horizon):
    assume(not Law(instance).check([]).accepted)
    scope = scope_of(Problem(instance, options))
    reaches = reaches_of(scope)
    arcs = arcs_of(scope, reaches, horizon)
    assert len(arcs) == count_arcs(scope, reaches, horizon)
    rows = set(zip(arcs.pebble.tolist(), arcs.edge.tolist(), arcs.tail.tolist(), arcs.step.tolist(), strict=True))
    assert len(rows) == len(arcs)


@settings(max_examples=60, deadline=None)
@given(instances(min_blocks=1, max_blocks=4), plan_options(), st.integers(1, 12))
def test_each_arc_lies_on_a_way_of_its_pebble_that_fits_the_horizon(instance, options, horizon):
    assume(not Law(instance).check([]).accepted)
    scope = scope_of(Problem(instance, options))
    reaches = reaches_of(scope)
    arcs = arcs_of(scope, reaches, horizon)
    for pebble, edge, tail, head, step in zip(arcs.pebble, arcs.edge, arcs.tail, arcs.head, arcs.step, strict=True):
        assert reaches[pebble].earliest[tail] <= step < horizon
        assert step + 1 + reaches[pebble].togo[head] <= horizon
        if edge == WAIT:
            assert tail == head
        else:
            assert (scope.gadget.edges[edge].tail, scope.gadget.edges[edge].head) == (tail, head)


@settings(max_examples=40, deadline=None)
@given(instances(min_blocks=1, max_blocks=3, max_buffers=1), plan_options(), st.integers(0, 2))
def test_every_step_of_a_cheapest_plan_is_an_arc(instance, options, spare):
    best = cheapest_plan(instance, options)
    assume(best is not None and best[0])
    scope = scope_of(Problem(instance, options))
    motion = motion_of(Problem(instance, options), scope, best[1])
    arcs = arcs_of(scope, reaches_of(scope), motion.steps + spare)
    there = set(zip(arcs.pebble.tolist(), arcs.step.tolist(), arcs.tail.tolist(), arcs.head.tolist(), strict=True))
    for step, (before, after) in enumerate(zip(motion.layers, motion.layers[1:], strict=False)):
        for pebble in scope.moving:
            assert (pebble, step, before[pebble], after[pebble]) in there


def test_a_horizon_shorter_than_the_shortest_way_has_no_arcs():
    instance = make_instance(
        name="x", blocks="a", stacks=["s1", "s2"], start={"s1": "a"}, goal=StacksGoal({"s2": ("a",)})
    )
    scope = scope_of(Problem(instance, PlanOptions(topple=False)))
    reaches = reaches_of(scope)
    assert reaches[0].shortest == 1
    assert count_arcs(scope, reaches, 0) == 0
    assert count_arcs(scope, reaches, 1) == 1
