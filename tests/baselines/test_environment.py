"""The law as a Gymnasium environment passes the library's checker, and says what the law says."""

import warnings

import numpy
import pytest

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402
from smash_baselines.environment import NAME, StackRearrangement  # noqa: E402

import smash  # noqa: E402
from smash.problem import Law, OnGoal, PositionsGoal, State, Unsupported  # noqa: E402

GOALS = {
    "stacks": {"s1": ["b"], "s2": ["a", "c"]},
    "positions": PositionsGoal({"a": ("s2", 1)}),
    "on": OnGoal({"a": "b"}, bottom=("c",), clear=("a",)),
}


def instance(goal, name="i"):
    return smash.make_instance({"s1": ["a", "b"], "s2": ["c"]}, goal, stacks=["s1", "s2"], buffers=1, name=name)


@pytest.mark.parametrize("goal", GOALS)
def test_it_passes_the_checker_of_the_library(goal):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(NAME, instances=instance(GOALS[goal]), disable_env_checker=True).unwrapped)


@pytest.mark.parametrize("topple", [True, False])
def test_the_mask_holds_what_the_law_allows_and_numbers_mean_actions(topple):
    env = StackRearrangement(instance(GOALS["stacks"]), topple=topple)
    _, info = env.reset(seed=3)
    for _ in range(40):
        legal = list(env.law.legal_actions(env.state))
        assert [env.action_of(int(n)) for n in info["action_mask"].nonzero()[0]] == sorted(legal, key=env.number_of)
        env.action_space.seed(1)
        _, _, ended, _, info = env.step(env.action_space.sample(info["action_mask"]))
        if ended:
            break


@pytest.mark.parametrize("goal", GOALS)
def test_an_optimal_plan_earns_minus_its_cost_and_ends_the_episode(goal):
    env = StackRearrangement(instance(GOALS[goal]))
    plan = smash.plan(env.instance)
    env.reset()
    steps = [env.step(env.number_of(action)) for action in plan.actions]
    assert sum(reward for _, reward, *_ in steps) == -plan.cost
    assert [ended for _, _, ended, _, _ in steps] == [False] * (plan.cost - 1) + [True]


def test_an_illegal_action_costs_and_changes_nothing():
    env = StackRearrangement(instance(GOALS["stacks"]))
    _, info = env.reset()
    before = env.state.key()
    number = int((info["action_mask"] == 0).nonzero()[0][0])
    _, reward, ended, cut, info = env.step(number)
    assert (reward, ended, cut, env.state.key()) == (-1.0, False, False, before)
    assert info["refused"]


@pytest.mark.parametrize("number", [-1, 999, 1.5, "0", None, numpy.array([0])])
def test_what_is_no_number_of_an_action_is_an_illegal_action(number):
    env = StackRearrangement(instance(GOALS["stacks"]))
    env.reset()
    before = env.state.key()
    _, reward, ended, cut, info = env.step(number)
    assert (reward, ended, cut, env.state.key()) == (-1.0, False, False, before)
    assert info["refused"] == "no such action"
    assert env.action_of(number) is None


@pytest.mark.parametrize("number", [-1, 1, 0.0, "0", True])
def test_a_reset_to_no_instance_is_refused_in_a_line(number):
    env = StackRearrangement(instance(GOALS["stacks"]))
    with pytest.raises(smash.SmashError, match=r"options\['instance'\]: .* is not allowed; whole numbers, 0 to 0$"):
        env.reset(options={"instance": number})


def test_a_reset_draws_an_instance_or_takes_the_one_asked_for():
    env = StackRearrangement([instance(GOALS["stacks"], name) for name in ("i", "j", "k")])
    assert env.reset(options={"instance": 2})[1]["instance"] == "k"
    assert {env.reset(seed=seed)[1]["instance"] for seed in range(12)} == {"i", "j", "k"}
    with pytest.raises(Unsupported, match="one shape"):
        StackRearrangement([instance(GOALS["stacks"]), smash.make_instance({"s1": ["a"]}, {"s1": ["a"]})])


def test_an_episode_without_an_end_is_truncated():
    env = StackRearrangement(instance(GOALS["stacks"]), limit=2)
    env.reset()
    assert not env.step(0)[3]
    assert env.step(0)[3]
    assert Law(env.instance).goal_shortfall(State.start_of(env.instance)) is not None
