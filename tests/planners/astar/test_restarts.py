"""Restarts with falling weights: what each has time for, what is a proof, and what is none."""

import math
from time import perf_counter
from typing import ClassVar

import pytest
from hypothesis import assume, given, settings

from smash.planners.astar import law_search, restarts
from smash.planners.astar.restarts import search_law_states
from smash.planners.protocol import SolveLog
from smash.problem import Costs, PlanOptions, StacksGoal, make_instance
from smash.problem.problem import Problem
from tests.cheapest import cheapest_plan
from tests.strategies import EVERY_KIND, family_instances, family_options

LONG = 60.0
"""Seconds that no search here takes."""


def swap(buffers=2, **more):
    """Return the problem of a pile a, b that is to be turned over without topple: 16, or no plan without buffers."""
    goal, costs = StacksGoal({"s": ("b", "a")}), Costs({"pick": 3})
    return Problem(
        make_instance({"s": ["a", "b"]}, goal, buffers=buffers, costs=costs, **more), PlanOptions(topple=False)
    )


class Scripted:
    """Stands for `LawSearch`: each search ends as its turn in `script` says: a plan or None, `ended`, a bound."""

    script: ClassVar = ()
    made: ClassVar = []

    def __init__(self, law, *, weight=1.0, below=math.inf):
        self.weight, self.below, self.expanded, self.bound, self.stop = weight, below, 1, 1, None
        self.ended = None
        self.turn = list(self.script[len(self.made)])
        self.made.append(self)

    def run(self, until, on_bound=None):
        self.stop = until
        plan, self.ended, bound = self.turn.pop(0)
        if bound is not None:
            on_bound(bound)
        return plan


@pytest.fixture
def scripted(monkeypatch):
    """A run of searches as scripted, on a clock that stands still at 0."""
    monkeypatch.setattr("smash.planners.protocol.clock.perf_counter", lambda: 0.0)
    monkeypatch.setattr(restarts, "LawSearch", Scripted)

    def run(log, *script):
        monkeypatch.setattr(Scripted, "script", script)
        monkeypatch.setattr(Scripted, "made", [])
        search_law_states(log.problem, log, 100.0)
        return [(search.weight, search.below, search.stop) for search in Scripted.made]

    return run


NOTHING = [(None, None, None)]


def plan_of(problem):
    """Return a cheapest plan, and one that costs more."""
    cost, actions = cheapest_plan(problem.instance, problem.options)
    return cost, actions


def test_weights_fall_and_each_search_has_its_share_of_the_time_left(scripted):
    ran = scripted(SolveLog(swap()), NOTHING, NOTHING, NOTHING)
    assert [weight for weight, _, _ in ran] == [4.0, 1.5, 1.0]
    assert [stop for _, _, stop in ran] == pytest.approx([10.0, 25.0, 100.0])


def test_a_weighted_search_hands_on_at_its_first_plan_and_the_next_looks_for_cheaper_ones(scripted):
    log = SolveLog(swap())
    cost, plan = plan_of(log.problem)
    ran = scripted(log, [(plan, None, None)], NOTHING, NOTHING)
    assert [below for _, below, _ in ran] == [math.inf, cost, cost]
    assert (log.cost, log.bound, log.refuted) == (cost, 1, None)
    assert log.entries[0].origin == "exact"


def test_the_exact_search_goes_on_after_a_plan_until_the_bound_meets_it(scripted):
    log = SolveLog(swap())
    cost, plan = plan_of(log.problem)
    scripted(log, NOTHING, NOTHING, [(plan, None, cost - 1), (None, None, cost)])
    assert (log.cost, log.bound, log.bound_origin) == (cost, cost, "astar")


@pytest.mark.parametrize("ended", [None, "memory"])
def test_a_search_that_was_not_exhausted_proves_nothing(scripted, ended):
    log = SolveLog(swap())
    ran = scripted(log, *[[(None, ended, None)]] * 3)
    assert len(ran) == 3
    assert (log.refuted, log.bound) == (None, 1)
    assert log.details == {"expanded": 1, "search": ended or "budget", "weight": 1.0}


@pytest.mark.parametrize("turn", [0, 1, 2])
def test_an_exhausted_search_of_any_weight_proves_that_there_is_no_plan(scripted, turn):
    log = SolveLog(swap())
    ran = scripted(log, *[NOTHING] * turn, [(None, "exhausted", None)])
    assert (len(ran), log.refuted) == (turn + 1, "astar")


def test_an_exhausted_search_of_any_weight_proves_the_plan_that_is_known(scripted):
    log = SolveLog(swap())
    cost, plan = plan_of(log.problem)
    log.offer(plan, "known")
    ran = scripted(log, [(None, "exhausted", None)])
    assert (len(ran), log.bound, log.bound_origin, log.refuted) == (1, cost, "astar", None)


def test_a_proven_plan_is_not_searched_for(scripted):
    log = SolveLog(swap())
    cost, plan = plan_of(log.problem)
    log.offer(plan, "known")
    log.prove(cost, "known")
    assert scripted(log) == []


def test_no_plan_is_proven_by_the_search_itself():
    log = SolveLog(swap(buffers=0, stacks=["t"]))
    search_law_states(log.problem, log, perf_counter() + LONG)
    assert (log.refuted, log.details["search"]) == ("astar", "exhausted")


def test_where_memory_ends_nothing_false_is_proven(monkeypatch):
    monkeypatch.setattr(law_search, "MOST_OPEN", 0)
    log = SolveLog(swap())
    search_law_states(log.problem, log, perf_counter() + LONG)
    assert (log.refuted, log.cost, log.details["search"]) == (None, None, "memory")
    assert log.bound <= plan_of(log.problem)[0]


@settings(max_examples=30, deadline=None)
@given(family_instances(max_blocks=3, max_stacks=2, kinds=EVERY_KIND), family_options())
def test_to_the_end_it_is_as_uniform_cost_search(instance, options):
    log, best = SolveLog(Problem(instance, options)), cheapest_plan(instance, options)
    assume(best is None or best[0])
    search_law_states(log.problem, log, perf_counter() + LONG)
    if best is None:
        assert (log.refuted, log.cost) == ("astar", None)
    else:
        assert log.cost == log.bound == best[0]
        assert log.refuted is None
