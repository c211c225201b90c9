"""The search as an object: what it takes over from others, where it pauses, why it ends."""

import math

import pytest

from smash.planners.astar import driver
from smash.planners.astar.driver import StateSearch
from smash.problem import PlanOptions, StacksGoal, make_instance
from smash.problem.sets.generators import generate
from smash.problem.views.numbered import Numbered, cost_of

NO_TOPPLE = PlanOptions(topple=False)


@pytest.fixture
def interpreted(monkeypatch):
    """The machine code is never there."""
    monkeypatch.setattr(driver.Compiler, "started", lambda: False)
    monkeypatch.setattr(driver.Compiler, "code", lambda deadline: None)


def swap():
    return Numbered.of(
        make_instance(
            name="swap",
            blocks="ab",
            stacks=["s1", "s2"],
            buffers=["u1"],
            start={"s1": "a", "s2": "b"},
            goal=StacksGoal({"s1": ("b",), "s2": ("a",)}),
        )
    )


def test_bounds_are_told_as_they_rise_and_never_above_the_plan_known(interpreted):
    told = []
    search = StateSearch(Numbered.of(generate("multi", 6, buffers=0, seed=3)[0]), NO_TOPPLE, 40, on_bound=told.append)
    plans = []
    while search.ended is None:
        plans.append(search.run(math.inf))
    assert told == sorted(set(told))
    assert told[-1] == search.lower_bound == min(cost_of(steps) for steps in plans if steps is not None)


def test_a_plan_that_meets_the_bound_needs_no_search(interpreted):
    search = StateSearch(swap(), NO_TOPPLE, upper=6)
    assert (search.ended, search.lower_bound, search.expanded) == ("proven", 6, 0)
    assert search.run(math.inf) is None


def test_a_bound_that_others_have_proven_ends_it_where_it_meets_the_plan_known(interpreted):
    search = StateSearch(Numbered.of(generate("multi", 7, buffers=0)[0]), NO_TOPPLE, 60)
    search.raise_bound(30, 31)
    assert search.ended is None
    search.raise_bound(31, 31)
    assert (search.ended, search.lower_bound) == ("proven", 31)


def test_without_the_machine_code_it_pauses_where_it_may_not_be_made(interpreted, monkeypatch):
    monkeypatch.setattr(driver, "INTERPRETED_NODES", 30)
    search = StateSearch(Numbered.of(generate("multi", 8, buffers=0, seed=3)[0]), NO_TOPPLE, 60)
    assert search.run(math.inf, may_compile=False) is None
    assert search.ended is None


def test_a_deadline_that_is_over_ends_no_search(interpreted):
    search = StateSearch(Numbered.of(generate("multi", 8, buffers=0, seed=3)[0]), NO_TOPPLE, 60)
    assert search.run(-math.inf) is None
    assert search.ended is None


def test_where_the_plan_known_is_too_far_from_the_bound_plans_are_looked_for_nearer_to_it(interpreted, monkeypatch):
    problem = Numbered.of(generate("multi", 6, buffers=0, seed=1)[0])
    plain = StateSearch(problem, NO_TOPPLE, 60)
    while plain.ended is None:
        plain.run(math.inf)
    far = StateSearch(problem, NO_TOPPLE, 10_000)
    while far.ended is None:
        far.run(math.inf)
    assert (far.ended, far.lower_bound) == ("proven", plain.lower_bound)
    monkeypatch.setattr(driver, "MOST_BUCKETS", 20_002)
    near = StateSearch(problem, NO_TOPPLE, 10_000)
    first = near.lower_bound
    while near.ended is None:
        assert near.run(math.inf) is None
    assert (near.ended, near.lower_bound) == ("too far", first + 1)


@pytest.mark.usefixtures("machine_code")
def test_spent_memory_ends_a_compiled_search(monkeypatch):
    monkeypatch.setattr(driver, "FIRST_NODES", 16)
    search = StateSearch(Numbered.of(generate("multi", 8, buffers=0, seed=3)[0]), NO_TOPPLE, 60, memory=1)
    while search.ended is None:
        search.run(math.inf)
    assert search.ended == "memory"
