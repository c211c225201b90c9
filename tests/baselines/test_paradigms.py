"""`cp-sat`, `clingo`, `didp`: three models written apart from each other, and one truth about every small problem."""

import random

import pytest

from smash.planners.protocol import Settings, why_refused
from smash.planners.registry import get_planner
from smash.problem import Costs, PlanOptions, PositionsGoal, StacksGoal, make_instance
from smash.problem.errors import Unsupported
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from smash.problem.sets.suites import read_suite
from tests.oracle import optimal_cost
from tests.relations import related

NAMES = ("cp-sat", "clingo", "didp")


@pytest.fixture(params=NAMES)
def planner(request):
    try:
        return get_planner(request.param)
    except Unsupported as error:
        pytest.skip(str(error))


def located(seed, most_blocks=4):
    """Draw a problem whose goal names locations: the whole arrangement, or some positions."""
    draw = random.Random(seed)
    names = [f"b{number}" for number in range(draw.randint(1, most_blocks))]
    stacks = [f"s{number}" for number in range(draw.randint(1, 3))]
    buffers = [f"u{number}" for number in range(draw.randint(0, 3 if len(stacks) < 3 else 1))]

    def arranged(places):
        piles = {place: [] for place in places}
        for block in draw.sample(names, len(names)):
            piles[draw.choice(places)].append(block)
        return piles

    start = arranged([*stacks, *buffers, *(["table"] if draw.random() < 0.4 else [])])
    table, goal = start.pop("table", []), arranged(stacks)
    held = start[stacks[0]].pop() if draw.random() < 0.2 and start[stacks[0]] else None
    if draw.random() < 0.5:
        cut = {place: pile[: draw.randint(0, len(pile))] for place, pile in goal.items()}
        places = {block: (at, height) for at, pile in cut.items() for height, block in enumerate(pile, start=1)}
        wanted = PositionsGoal(places)
    else:
        wanted = StacksGoal({place: tuple(pile) for place, pile in goal.items()})
    instance = make_instance(
        start, wanted, name=f"located-{seed}", blocks=names, stacks=stacks, buffers=buffers, table=table, hand=held
    )
    return Problem(instance, PlanOptions(draw.random() < 0.6, draw.choice([None, None, 1, 2])))


def judge(planner, made, budget=60.0):
    """Whatever the planner says is true, and it says all there is to say."""
    assert why_refused(planner, made, Settings()) is None
    cost = optimal_cost(made.instance, made.options)
    seen = []
    answer = planner.plan(made, Settings(), budget if cost is not None else 0.3, lambda *found: seen.append(found))
    assert "refusals" not in answer.details
    if cost is None:
        assert answer.actions is None
        return
    assert answer.cost == cost, (made.instance, made.options)
    assert made.law.check(answer.actions).accepted
    assert answer.lower_bound is None or answer.lower_bound <= cost
    assert answer.status == "optimal"
    assert [cost for _, cost, _ in seen] == sorted({cost for _, cost, _ in seen}, reverse=True)


@pytest.mark.parametrize("draw", [located, related], ids=["located", "related"])
@pytest.mark.parametrize("part", range(5))
def test_optima_agree_with_exhaustive_search(planner, draw, part):
    for seed in range(12 * part, 12 * part + 12):
        judge(planner, draw(seed))


@pytest.mark.slow
@pytest.mark.parametrize("draw", [located, related], ids=["located", "related"])
@pytest.mark.parametrize("part", range(10))
def test_optima_agree_with_exhaustive_search_on_many(planner, draw, part):
    for seed in range(1000 + 100 * part, 1100 + 100 * part):
        judge(planner, draw(seed))


@pytest.mark.parametrize("topple", [True, False])
def test_optima_of_the_committed_sets_agree_with_the_search_over_states(planner, topple):
    for instance in read_suite("multi-4")[:3]:
        made = Problem(instance, PlanOptions(topple))
        answer = planner.plan(made, Settings(), 60)
        assert (answer.status, answer.cost) == ("optimal", get_planner("astar").plan(made, Settings(), 60).cost)


def test_what_costs_or_carries_is_unsupported(planner):
    goal, start = StacksGoal({"t": ("a",)}), {"s": ["a"]}
    priced = make_instance(start, goal, stacks=["s", "t"], costs=Costs({"pick": 3}))
    lifts = make_instance(start, goal, stacks=["s", "t"], capacities={"lift": 2})
    assert "counts actions" in why_refused(planner, Problem(priced), Settings())
    assert "lift" in why_refused(planner, Problem(lifts), Settings())


@pytest.mark.parametrize("name", ["cp-sat", "clingo"])
def test_a_horizon_that_is_too_short_proves_no_more_than_it_holds(name):
    try:
        planner = get_planner(name)
    except Unsupported as error:
        pytest.skip(str(error))
    made = Problem(read_suite("multi-4")[0], PlanOptions(False))
    cost = optimal_cost(made.instance, made.options)
    short = planner.plan(made, Settings(horizon=cost // 2 - 1), 60)
    assert (short.status, short.lower_bound) == ("unknown", cost)
    long = planner.plan(made, Settings(horizon=cost // 2 + 2), 60)
    assert (long.status, long.cost) == ("optimal", cost)


@pytest.mark.parametrize("name", NAMES)
def test_without_its_package_the_extra_is_named(monkeypatch, name):
    module = {"cp-sat": "ortools", "clingo": "clingo", "didp": "didppy"}[name]
    monkeypatch.setitem(__import__("sys").modules, module, None)
    with pytest.raises(Unsupported, match=rf"pip install 'smash-testbed\[{name}\]'"):
        get_planner(name)


def test_a_model_that_takes_longer_than_the_budget_is_not_begun(planner):
    (large,) = generate("multi", 100, buffers=100, seed=2)
    answer = planner.plan(Problem(large), Settings(), 0.5)
    assert answer.status == "unknown"
    assert "takes longer to build" in answer.details["stopped"]
