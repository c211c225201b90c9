"""smash-flow: equal to exhaustive search, honest about horizons, every goal kind and start."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smash.gadget.decode import decode
from smash.gadget.encode import encode
from smash.gadget.motion import motion_fault
from smash.planners.flow import FlowPlanner
from smash.planners.flow.arcs import reaches_of
from smash.planners.flow.horizon import step_bound
from smash.planners.flow.model import build
from smash.planners.flow.scope import correct_blocks, scope_of
from smash.planners.flow.warm import motion_of
from smash.planners.greedy import GreedyPlanner
from smash.planners.protocol import Settings, SolveOptions
from smash.problem import Law, OnGoal, PlanOptions, PositionsGoal, StacksGoal, make_instance
from smash.problem.files.instances import read_instance
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from smash.problem.sets.suites import read_suite
from tests.cheapest import cheapest_plan
from tests.gadget.plans import walks
from tests.oracle import optimal_cost
from tests.strategies import family_instances, family_options, instances, plan_options

EXAMPLES = Path(__file__).parents[3] / "examples"


def solve(instance, options=None, budget=20.0):
    return FlowPlanner().solve(instance, options or SolveOptions(), budget)


def agree_with_exhaustive_search(instance, options, budget=20.0):
    """Whatever the planner says is true; where it says optimal, so is the oracle's cost."""
    true_cost = optimal_cost(instance, options)
    result = solve(instance, SolveOptions(options.topple, options.max_topple), budget)
    if true_cost is None:
        assert result.status == "infeasible"
        return result
    assert result.status != "infeasible"
    if result.lower_bound is not None:
        assert result.lower_bound <= true_cost
    if result.actions is not None:
        assert Law(instance, options).check(result.actions).accepted
        assert result.cost >= true_cost
    if result.status == "optimal":
        assert result.cost == true_cost
    return result


@settings(max_examples=25, deadline=None)
@given(instances(max_blocks=3, max_stacks=3, max_buffers=1, odd_names=True), plan_options())
def test_small_instances_of_every_kind_agree_with_exhaustive_search(instance, options):
    agree_with_exhaustive_search(instance, options)


def agree_with_uniform_cost_search(instance, options, budget=10.0):
    """The same for the whole family and any costs; the cheapest plan is in the model of the steps of its cost."""
    try:
        found = cheapest_plan(instance, options, most_states=20_000)
    except MemoryError:
        return
    result = solve(instance, SolveOptions(options.topple, options.max_topple, without=options.without), budget)
    assert "refusals" not in result.details
    if found is None:
        assert result.actions is None
        return
    cost, actions = found
    assert result.status != "infeasible"
    assert result.lower_bound is None or result.lower_bound <= cost
    if result.actions is not None:
        assert Law(instance, options).price(result.actions) == result.cost >= cost
    if result.status == "optimal":
        assert result.cost == cost
    if cost:
        the_model_holds(instance, options, actions, cost)


def the_model_holds(instance, options, actions, cost):
    """A cheapest plan fits into the steps of its cost, and is a solution of that model, at its cost."""
    problem = Problem(instance, options)
    scope = scope_of(problem)
    bound = step_bound(problem, scope)
    steps = bound.steps(cost)
    motion = motion_of(problem, scope, actions)
    assert motion_fault(motion) is None
    assert bound.least_cost <= cost
    assert motion.steps <= steps
    model = build(scope, reaches_of(scope), steps)
    vector = model.vector(motion)
    assert vector is not None
    assert model.milp.objective @ vector == cost
    assert model.motion(vector) == motion.padded(steps)


@settings(max_examples=15, deadline=None)
@given(family_instances(max_blocks=2), family_options())
def test_the_whole_family_agrees_with_uniform_cost_search(instance, options):
    agree_with_uniform_cost_search(instance, options, 3.0)


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(family_instances(max_blocks=3), family_options())
def test_the_whole_family_agrees_with_uniform_cost_search_on_3_blocks(instance, options):
    agree_with_uniform_cost_search(instance, options)


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(instances(max_blocks=4, max_stacks=3, max_buffers=5), plan_options())
def test_instances_up_to_4_blocks_agree_with_exhaustive_search(instance, options):
    agree_with_exhaustive_search(instance, options, 5.0)


def test_a_rotation_of_three_tops_costs_7_and_not_6():
    instance = make_instance(
        name="cycle",
        blocks=["a", "b", "c"],
        stacks=["s1", "s2", "s3"],
        start={"s1": ["a"], "s2": ["b"], "s3": ["c"]},
        goal=StacksGoal({"s1": ["c"], "s2": ["a"], "s3": ["b"]}),
    )
    assert optimal_cost(instance) == 7
    result = solve(instance)
    assert (result.status, result.cost, result.lower_bound) == ("optimal", 7, 7)


def test_two_topples_under_a_cap_are_not_counted_as_one():
    instance = make_instance(
        name="cap",
        blocks=["t", "a", "b"],
        stacks=["s1", "s2"],
        start={"s1": ["t", "a", "b"]},
        goal=PositionsGoal({"t": ("s2", 1)}),
    )
    assert optimal_cost(instance, PlanOptions(True, 1)) == 4
    result = solve(instance, SolveOptions(max_topple=1))
    assert (result.status, result.cost) == ("optimal", 4)
    assert solve(instance).cost == 3


@pytest.mark.parametrize(("topple", "cost"), [(True, 3), (False, 8)])
def test_figure_1(topple, cost):
    result = solve(read_instance(EXAMPLES / "figure1.json"), SolveOptions(topple=topple))
    assert (result.status, result.cost) == ("optimal", cost)


@pytest.mark.parametrize("horizon", range(1, 9))
def test_a_horizon_that_is_too_short_is_never_infeasible_and_its_best_plan_never_wrongly_optimal(horizon):
    instance = read_instance(EXAMPLES / "figure1.json")
    result = solve(instance, SolveOptions(horizon=horizon))
    assert result.status != "infeasible"
    assert result.lower_bound is None or result.lower_bound <= 3
    if result.status == "optimal":
        assert result.cost == 3


@pytest.mark.parametrize("horizon", range(1, 6))
def test_no_horizon_proves_too_much_of_a_pile_that_starts_on_a_buffer(horizon):
    """The upper block has to be put on the stack and toppled: 3 moves and a topple."""
    instance = make_instance(
        name="x", blocks="ab", stacks=["s1"], buffers=["u1"], start={"u1": "ab"}, goal=StacksGoal({"s1": ("a", "b")})
    )
    assert solve(instance, SolveOptions(horizon=horizon)).lower_bound <= 7 == optimal_cost(instance)


def test_a_warm_start_gives_its_plan_at_once_and_the_same_optimum():
    instance = generate("multi", 4, seed=7)[0]
    cold, warm = solve(instance), solve(instance, SolveOptions(warm_start="greedy"))
    assert warm.incumbents[0].origin == "greedy"
    assert {incumbent.origin for incumbent in cold.incumbents} == {"milp"}
    assert (cold.status, warm.status) == ("optimal", "optimal")
    assert cold.cost == warm.cost == optimal_cost(instance)


def test_a_start_that_is_the_goal_needs_nothing():
    instance = make_instance(name="x", blocks=["a"], stacks=["s1"], start={"s1": ["a"]}, goal=OnGoal({}, ("a",)))
    result = solve(instance)
    assert (result.status, result.cost, result.bound_origin) == ("optimal", 0, "start")


def test_two_locations_without_buffer_or_topple_may_be_infeasible():
    instance = make_instance(
        name="x",
        blocks=["a", "b"],
        stacks=["s1", "s2"],
        start={"s1": ["a", "b"]},
        goal=StacksGoal({"s1": ["b", "a"]}),
    )
    assert solve(instance, SolveOptions(topple=False)).status == "infeasible"
    assert solve(instance).cost == 5


def test_what_is_too_large_is_said_at_once_and_is_not_infeasible():
    instance = generate("multi", 60, seed=1)[0]
    result = solve(instance, budget=5.0)
    assert (result.status, result.incumbents) == ("unknown", ())
    assert any(words in result.details["stopped"] for words in ("at most", "edges", "time was up"))


@pytest.mark.parametrize(("blocks", "bound"), [(60, 120), (450, 0)])
def test_what_cannot_be_built_in_the_budget_is_not_begun(blocks, bound):
    result = FlowPlanner().solve(generate_one(blocks), SolveOptions(), budget=1.5)
    assert (result.status, result.lower_bound) == ("unknown", bound)
    assert "stopped" in result.details


def generate_one(blocks):
    return generate("multi", blocks, buffers=2, seed=5)[0]


@settings(max_examples=60, deadline=None)
@given(walks(max_blocks=5, max_buffers=6))
def test_any_plan_fits_the_steps_of_its_cost_and_its_buffers_can_be_renamed(walk):
    """The walk's end is made the goal, so that the walk is a plan for it."""
    instance, actions, state = walk
    goal = PositionsGoal(
        {
            block: (location, height)
            for location in instance.stacks
            for height, block in enumerate(state.piles[location], start=1)
        }
    )
    made = make_instance(
        name="x", blocks=instance.blocks, stacks=instance.stacks, buffers=instance.buffers,
        start=instance.start, table=instance.table, goal=goal,
    )  # fmt: skip
    problem = Problem(made)
    if problem.solved:
        return
    scope = scope_of(problem)
    motion = motion_of(problem, scope, actions)
    assert motion_fault(motion) is None
    decoded = decode(motion, Law(scope.instance))
    assert Law(scope.instance).check(decoded).accepted
    assert len(decoded) <= len(actions)


@pytest.mark.parametrize("topple", [True, False])
@pytest.mark.parametrize("suite", ["multi-4", "single-4", "multi-6"])
def test_greedy_plans_are_solutions_of_the_model_within_the_steps_of_their_cost(suite, topple):
    for instance in read_suite(suite)[:3]:
        problem = Problem(instance, PlanOptions(topple))
        plan = GreedyPlanner().plan(problem, Settings(), 5.0).actions
        if not plan:
            continue
        scope = scope_of(problem)
        motion = motion_of(problem, scope, plan)
        steps = step_bound(problem, scope).steps(len(plan))
        assert motion.steps <= steps
        model = build(scope, reaches_of(scope), steps)
        vector = model.vector(motion)
        assert vector is not None
        assert model.milp.objective @ vector == len(plan)
        assert model.motion(vector) == motion.padded(steps)


@given(st.data())
@settings(max_examples=20, deadline=None)
def test_blocks_of_a_correct_bottom_part_are_left_out(data):
    instance = data.draw(instances(min_blocks=1, kinds=("stacks",)))
    correct = correct_blocks(instance)
    for location, pile in instance.start.items():
        wanted = instance.goal.stacks.get(location, ())
        common = [a for a, b in zip(pile, wanted, strict=False) if a == b and a in correct]
        assert all(pile.index(block) == index for index, block in enumerate(common))


def test_encoding_keeps_the_goal_reached():
    instance = read_instance(EXAMPLES / "figure1.json")
    plan = solve(instance).actions
    assert Law(instance).check(decode(encode(instance, plan), Law(instance))).accepted
