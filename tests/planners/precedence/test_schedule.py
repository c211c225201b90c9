"""Schedules: choices that hit every cycle carried out, at the cost that they say, where the blocks find places."""

import itertools
import math

import pytest
from hypothesis import assume, given, settings

from smash.planners.precedence import schedule
from smash.planners.precedence.dive import dive
from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.schedule import Scheduler, chosen_of
from smash.problem import Law, OnGoal, PlanOptions, PositionsGoal, StacksGoal, make_instance
from smash.problem.problem import Problem
from tests.arrangements import wide
from tests.strategies import instances, plan_options


def scheduled(instance, options):
    """Return a plan for choices that hit every cycle, and what they cost with all that every plan needs."""
    problem = Problem(instance, options)
    graph = build_graph(problem)
    chosen = dive(graph)
    scheduler = Scheduler(problem, chosen_of(graph.choices, chosen))
    return scheduler.plan(math.inf), graph.base_cost + sum(graph.choices[choice].cost for choice in chosen)


@settings(max_examples=100, deadline=None)
@given(instances(max_blocks=5), plan_options())
def test_a_schedule_is_a_legal_plan_at_the_cost_of_its_choices(instance, options):
    assume(Problem(instance, options).infeasible is None)
    plan, cost = scheduled(instance, options)
    if plan is None:
        return
    verdict = Law(instance, options).check(plan)
    assert verdict.accepted
    assert verdict.cost == cost


@settings(max_examples=80, deadline=None)
@given(instances(max_blocks=6, kinds=("stacks", "positions"), buffer_start=False), plan_options())
def test_with_topple_and_empty_buffers_there_always_is_one(instance, options):
    """Nobody is put aside: toppled blocks wait in the table region (theorem 1)."""
    assume(options.topple)
    assert scheduled(instance, options)[0] is not None


@pytest.mark.parametrize("seed", range(3))
def test_without_topple_there_is_one_with_a_buffer_for_each_block(seed):
    assert scheduled(wide(30, 4, seed, buffers=30), PlanOptions(topple=False))[0] is not None


def test_a_block_put_aside_needs_a_place():
    def swap(buffers):
        return make_instance(
            name="x",
            blocks="ab",
            stacks=["s1", "s2"],
            buffers=["u1"][:buffers],
            start={"s1": "a", "s2": "b"},
            goal=StacksGoal({"s1": ("b",), "s2": ("a",)}),
        )

    assert scheduled(swap(buffers=0), PlanOptions(topple=False))[0] is None
    assert len(scheduled(swap(buffers=1), PlanOptions(topple=False))[0]) == 6


def test_a_base_of_relations_is_put_at_an_empty_location():
    instance = make_instance(
        name="x", blocks="ab", stacks=["s1", "s2"], start={"s1": "ab"}, goal=OnGoal({"a": "b"}, ("b",))
    )
    plan, cost = scheduled(instance, PlanOptions(topple=False))
    assert len(plan) == cost == 4


def test_a_block_that_the_goal_does_not_name_may_ride_on_a_stack_that_is_toppled():
    instance = make_instance(
        {"s1": ("b3",), "u1": ("b2", "b4", "b1")},
        PositionsGoal({"b2": ("s1", 1), "b3": ("s1", 2), "b4": ("s1", 3)}),
        name="x",
        stacks=["s1"],
        buffers=["u1"],
    )
    plan, cost = scheduled(instance, PlanOptions(max_topple=2))
    assert plan is None or len(plan) == cost


def test_a_schedule_is_given_up_at_its_deadline(monkeypatch):
    problem = Problem(wide(30, 30, seed=1), PlanOptions())
    graph = build_graph(problem)
    scheduler = Scheduler(problem, chosen_of(graph.choices, dive(graph)))
    assert scheduler.plan(math.inf) is not None
    clock = itertools.count()
    monkeypatch.setattr(schedule, "perf_counter", lambda: float(next(clock)))
    assert scheduler.plan(10.0) is None
    assert next(clock) < 30
