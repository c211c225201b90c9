"""The search over filed states, share by share: cheapest first, nothing twice, full stores go on after growing."""

import pytest
from hypothesis import assume, given, settings

from smash.planners.astar.compiled import INTERPRETED
from smash.planners.astar.engine import StoreEngine
from smash.planners.astar.search import (
    BEST,
    DROPPED,
    EXPANDED,
    FLOOR,
    FULL,
    NO_ROOM,
    NODES,
    PROVEN,
    RUNNING,
    UPPER,
    file_node,
)
from smash.planners.astar.store import grown
from smash.planners.astar.task import make_setting
from smash.problem import Law, PlanOptions
from smash.problem.sets.generators import generate
from smash.problem.views.numbered import Numbered, cost_of
from tests.oracle import optimal_cost
from tests.strategies import EVERY_KIND, instances, plan_options


def opened(instance, options, upper, nodes=20_000, share=50):
    engine = StoreEngine(make_setting(Numbered.of(instance), options), INTERPRETED, False)
    engine.open(nodes, min(engine.first_bound(), upper), upper)
    engine.share = share
    return engine


@settings(max_examples=40, deadline=None)
@given(instances(max_blocks=4, kinds=EVERY_KIND), plan_options())
def test_where_no_cheaper_plan_is_left_the_best_one_is_the_optimum(instance, options):
    best = optimal_cost(instance, options)
    assume(best is not None)
    engine = opened(instance, options, best + 5)
    floors = [engine.counter(FLOOR)]
    while engine.expand() == RUNNING:
        floors.append(engine.counter(FLOOR))
    assert floors == sorted(floors)
    assert all(floor <= best for floor in floors)
    assert engine.counter(UPPER) == best
    problem = Numbered.of(instance)
    steps = engine.steps(problem, engine.path())
    assert cost_of(steps) == best
    assert Law(instance, options).check(problem.actions(steps)).accepted


@pytest.mark.parametrize("cap", [1, 2])
def test_no_estimate_is_passed_over(cap):
    options = PlanOptions(max_topple=cap)
    for instance in generate("multi", 5, buffers=0, count=5):
        best = optimal_cost(instance, options)
        engine = opened(instance, options, best + 5, share=1000)
        assert engine.expand() == PROVEN
        assert engine.counter(UPPER) == best


@settings(max_examples=30, deadline=None)
@given(instances(min_blocks=1, max_blocks=4), plan_options())
def test_a_plan_that_is_known_to_be_best_is_not_found_again(instance, options):
    best = optimal_cost(instance, options)
    assume(best)
    engine = opened(instance, options, best)
    while (outcome := engine.expand()) == RUNNING:
        pass
    assert outcome == PROVEN
    assert engine.counter(BEST) == -1


@pytest.mark.parametrize("topple", [True, False])
def test_a_full_store_goes_on_where_it_was_once_it_has_grown(topple):
    instance, options = generate("multi", 6, buffers=1, seed=3)[0], PlanOptions(topple)
    roomy, narrow = (opened(instance, options, 40, nodes) for nodes in (20_000, 3))
    while roomy.expand() == RUNNING:
        pass
    grew = 0
    while (outcome := narrow.expand()) != PROVEN:
        if outcome == FULL:
            assert narrow.counter(NODES) == narrow.store.shape[2]
            grew += 1
            narrow.store = grown(narrow.task, narrow.store, 2 * int(narrow.store.shape[2]), INTERPRETED, False)
    assert grew
    assert narrow.counter(UPPER) == roomy.counter(UPPER)


def test_a_share_is_no_more_expansions_than_it_says():
    engine = opened(generate("multi", 7, buffers=0)[0], PlanOptions(topple=False), 60, share=7)
    for shares in range(1, 4):
        assert engine.expand() == RUNNING
        assert engine.counter(EXPANDED) == 7 * shares


@pytest.fixture
def start():
    """A search whose store holds the start alone, reached at cost 4."""
    engine = opened(generate("multi", 5, buffers=1)[0], PlanOptions(topple=False), 60, nodes=2)
    engine.store.counters[NODES] = 0
    engine.store.table[:] = [0] * len(engine.store.table)
    assert filed(engine, 4) == 0
    return engine


def filed(engine, cost):
    engine.unpack_start()
    return file_node(engine.task, engine.cells, engine.store, -1, cost, -1, 0, 0)


def test_a_state_reached_at_no_less_is_dropped(start):
    assert filed(start, 4) == filed(start, 6) == DROPPED
    assert start.counter(NODES) == 1


def test_a_state_reached_for_less_takes_the_place_of_the_dearer_node(start):
    assert filed(start, 2) == 1
    assert list(start.store.stale[:2]) == [1, 0]


def test_without_room_nothing_is_filed(start):
    assert filed(start, 2) == 1
    assert filed(start, 0) == NO_ROOM
    assert start.counter(NODES) == 2


def test_what_cannot_be_cheaper_than_the_plan_known_is_dropped(start):
    start.store.counters[UPPER] = start.first_bound()
    assert filed(start, 0) == DROPPED


@pytest.mark.parametrize("topple", [True, False])
def test_with_few_moves_allowed_at_a_time_the_optimum_is_the_same(topple):
    instance, options = generate("multi", 5, buffers=1, seed=3)[0], PlanOptions(topple)
    best = optimal_cost(instance, options)
    whole, parts = (opened(instance, options, best + 2) for _ in range(2))
    parts.tries = 3
    for engine in (whole, parts):
        while (outcome := engine.expand()) == RUNNING:
            pass
        assert outcome == PROVEN
    assert parts.counter(UPPER) == whole.counter(UPPER) == best
