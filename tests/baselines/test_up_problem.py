import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from smash_baselines.encodings import TOPPLE_ENCODINGS, unsupported_reason
from smash_baselines.steps import steps_of
from smash_baselines.task import compile_instance

from smash.problem import Law, PlanOptions, State
from smash.problem.actions.topple import Topple
from smash.problem.problem import Problem
from tests.baselines.test_encodings import random_walk
from tests.strategies import instances, plan_options

pytest.importorskip("unified_planning")

from smash_baselines.up_problem import problem_of_task, up_accepts, up_plan


@settings(max_examples=5, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(instances(max_blocks=4), plan_options(), st.sampled_from(TOPPLE_ENCODINGS), st.integers(0, 99))
def test_the_library_simulates_what_the_law_does(instance, options, wanted, seed):
    """Along a random legal walk the library accepts each step, and sees the goal exactly when the law does."""
    if unsupported_reason(Problem(instance, options), wanted):
        return
    task = compile_instance(instance, options, wanted)
    problem = problem_of_task(task)
    from unified_planning.engines import UPSequentialSimulator

    simulator = UPSequentialSimulator(problem)
    state = simulator.get_initial_state()
    law, own = Law(instance, options), State.start_of(instance)
    actions = random_walk(instance, options, 10, seed)
    for number, action in enumerate(actions):
        law.apply(own, action)
        for step in steps_of(actions[: number + 1], task)[len(steps_of(actions[:number], task)) :]:
            [grounded] = up_plan([step], problem).actions
            state = simulator.apply(state, grounded)
            assert state is not None, step
        assert simulator.is_goal(state) == (law.goal_shortfall(own) is None)


@settings(max_examples=5, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(instances(max_blocks=4), st.sampled_from(TOPPLE_ENCODINGS), st.integers(0, 99))
def test_the_librarys_validator_agrees_with_the_law(instance, wanted, seed):
    options = PlanOptions()
    task = compile_instance(instance, options, wanted)
    actions = random_walk(instance, options, 6, seed)
    assert up_accepts(actions, task) == Law(instance, options).check(actions).accepted


def test_a_buffer_cannot_be_toppled_in_either_encoding():
    from unified_planning.engines import UPSequentialSimulator

    from smash.problem import make_instance
    from smash.problem.model import OnGoal

    instance = make_instance(
        name="i", blocks=["x", "y"], stacks=["p"], buffers=["u"], start={"u": ["x", "y"]}, goal=OnGoal({"x": "y"})
    )
    for wanted in TOPPLE_ENCODINGS:
        problem = problem_of_task(compile_instance(instance, PlanOptions(), wanted))
        simulator = UPSequentialSimulator(problem)
        names = {a.name for a, _ in simulator.get_applicable_actions(simulator.get_initial_state())}
        assert names == {"pick"}


def test_a_chain_that_drops_nothing_does_not_exist():
    from smash.problem import make_instance
    from smash.problem.model import PositionsGoal

    instance = make_instance(name="i", blocks=["x", "y"], stacks=["p"], start={"p": ["x", "y"]}, goal=PositionsGoal({}))
    steps = steps_of([Topple("p", 2)], compile_instance(instance, PlanOptions(), "chain"))
    assert [step[0] for step in steps] == ["topple-begin", "topple-end"]
