"""The search over horizons: first a short model, then one that holds every cheaper plan; what is too large is said."""

import math
from dataclasses import replace

import pytest

from smash.gadget.encode import encode
from smash.planners.flow.search import FlowSearch, TooLarge, check_gadget_size
from smash.planners.flow.warm import motion_of
from smash.planners.protocol import Settings, SolveLog
from smash.problem import Pick, Place, PlanOptions, StacksGoal, make_instance
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate


def turned(options=None):
    goal = StacksGoal({"s": ("b", "a")})
    instance = make_instance(
        name="x", blocks="ab", stacks=["s"], buffers=["u", "v"], start={"s": ("a", "b")}, goal=goal
    )
    return Problem(instance, options or PlanOptions())


def search(problem, **settings):
    return FlowSearch(problem, Settings(**settings), SolveLog(problem), math.inf)


@pytest.mark.parametrize(("topple", "cost"), [(True, 5), (False, 8)])
def test_a_short_horizon_gives_the_plan_and_a_longer_one_the_proof(topple, cost):
    found = search(turned(PlanOptions(topple)))
    first = found.first_horizon()
    found.run()
    stages = found.log.details["stages"]
    assert (found.log.cost, found.log.bound, found.log.bound_origin) == (cost, cost, "milp")
    assert stages[0]["horizon"] == first < stages[-1]["horizon"]
    assert stages[-1]["started_from_a_plan"] == topple  # without, the first horizon holds no plan
    assert stages[-1]["horizon"] >= found.bound.steps(cost - 1)


@pytest.mark.parametrize(("topple", "cost"), [(True, 5), (False, 8)])
def test_on_cpsat_the_shortest_horizon_comes_first_and_the_proof_is_as_good(topple, cost):
    pytest.importorskip("ortools")
    found = search(turned(PlanOptions(topple)), solver="cpsat")
    found.run()
    horizons = [stage["horizon"] for stage in found.log.details["stages"]]
    assert horizons[0] == found.shortest_horizon() < found.first_horizon()
    assert horizons == sorted(set(horizons))
    assert (found.log.cost, found.log.bound, found.log.bound_origin) == (cost, cost, "milp")


def test_every_plan_fits_buffers_that_are_used_in_order_and_another_order_does_not():
    parts = {"stacks": ["s", "t"], "buffers": ["u", "v"], "start": {"s": "ab", "t": "cd"}, "blocks": "abcd"}
    problem = Problem(make_instance(name="x", **parts, goal=StacksGoal({"s": "ba", "t": "cd"})))
    found = search(problem)
    assert found.scope.alike == ()  # two blocks move: each buffer belongs to one of them
    problem = Problem(make_instance(name="x", **parts, goal=StacksGoal({"s": "ba", "t": "dc"})), PlanOptions(False))
    found = search(problem)
    assert found.scope.alike == ("u", "v")
    moves = [("b", "s", "v"), ("a", "s", "u"), ("b", "v", "s"), ("a", "u", "s"), ("d", "t", "v"), ("c", "t", "u")]
    moves += [("d", "v", "t"), ("c", "u", "t")]
    plan = [act for block, source, target in moves for act in (Pick(block, source), Place(block, target))]
    renamed = motion_of(problem, found.scope, plan)
    model = found.model(renamed.steps)
    assert model.vector(renamed) is not None
    assert model.vector(encode(found.scope.instance, plan, found.scope.gadget)) is None


def test_a_given_horizon_is_the_only_one():
    found = search(turned(), horizon=3)
    found.run()
    assert [stage["horizon"] for stage in found.log.details["stages"]] == [3]
    assert found.log.cost is None
    assert 4 <= found.log.bound <= 5


def test_a_plan_that_is_there_fits_the_first_horizon():
    problem = turned(PlanOptions(topple=False))
    found = search(problem)
    cold = found.first_horizon()
    detour = (Pick("b", "s"), Place("b", "u"), Pick("b", "u"), Place("b", "v"), Pick("a", "s"), Place("a", "u"))
    found.log.offer((*detour, Pick("b", "v"), Place("b", "s"), Pick("a", "u"), Place("a", "s")), "greedy")
    assert found.log.cost == 10
    assert found.first_horizon() >= max(cold, motion_of(problem, found.scope, found.log.best).steps)


def test_a_gadget_or_a_model_that_is_too_large_is_refused():
    wide = generate("multi", 400, buffers=2, seed=5)[0]
    check_gadget_size(wide)
    with pytest.raises(TooLarge, match="edges"):
        check_gadget_size(wide, seconds=1.0)
    found = search(turned())
    with pytest.raises(TooLarge, match="arcs at horizon 100000"):
        found.model(100_000)


def test_without_time_it_says_before_which_horizon():
    found = search(turned())
    found.solving = replace(found.solving, until=-math.inf)
    found.run()
    assert "before the model of horizon" in found.log.details["stopped"]
