"""The protocol of planners: the methods table and its loop, the log, and planners from outside."""

import copy
import pickle
import textwrap
from pathlib import Path

import pytest

from smash.planners.portfolio import SmashPlanner
from smash.planners.protocol import (
    BasePlanner,
    IncumbentLog,
    Method,
    MethodPlanner,
    PlanResult,
    Settings,
    SolveLog,
    SolveOptions,
    anything,
    ask,
    not_plain,
    plain,
    plan_options,
    settings_of,
    walk,
)
from smash.planners.registry import get_planner, planner_names
from smash.problem import Costs, Pick, Place, PlanOptions, StacksGoal, Topple, make_instance, read_instance
from smash.problem.errors import Unsupported
from smash.problem.problem import Problem

LATER = float("inf")
SCOOP = Path(__file__).parents[2] / "examples" / "scoop.json"


def swap():
    return make_instance(
        name="swap",
        blocks=["a", "b"],
        stacks=["s1", "s2"],
        buffers=["u1"],
        start={"s1": ["a", "b"]},
        goal=StacksGoal({"s1": ("b", "a")}),
    )


def noting(ran, name, takes=anything, act=lambda log: None, **share):
    def run(problem, log, until):
        ran.append((name, until))
        act(log)

    return Method(name, takes, run, **share)


def test_methods_run_in_their_order_until_the_log_is_settled():
    ran = []
    log = SolveLog(Problem(swap()))
    proves = noting(ran, "second", act=lambda log: log.refute("second"))
    walk([noting(ran, "first"), proves, noting(ran, "third")], log.problem, log, LATER)
    assert [name for name, _ in ran] == ["first", "second"]
    assert log.plan().status == "infeasible"
    assert list(log.details["seconds"]) == ["first", "second"]


def test_a_method_that_does_not_take_the_problem_is_left_out_with_its_reason():
    ran = []
    log = SolveLog(Problem(read_instance(SCOOP)))
    walk([noting(ran, "fast", plain), noting(ran, "general", not_plain)], log.problem, log, LATER)
    assert [name for name, _ in ran] == ["general"]
    assert log.details["left_out"] == {"fast": "it counts picks, places and topples"}


def test_after_the_deadline_only_the_first_method_runs():
    ran = []
    log = SolveLog(Problem(swap()))
    walk([noting(ran, "first"), noting(ran, "second")], log.problem, log, 0.0)
    assert [name for name, _ in ran] == ["first"]


def test_a_share_is_of_the_time_left_and_never_more_than_the_most(monkeypatch):
    monkeypatch.setattr("smash.planners.protocol.methods.perf_counter", lambda: 100.0)
    monkeypatch.setattr("smash.planners.protocol.clock.perf_counter", lambda: 100.0)

    def until(**share):
        return noting([], "m", **share).until(110.0)

    assert until() == 110.0
    assert until(share=0.5) == 105.0
    assert until(share=0.5, most=2.0) == 102.0
    assert until(share=lambda: 0.25) == 102.5


class Table(MethodPlanner):
    proves = True

    def __init__(self, *methods):
        self._methods = methods

    def methods(self, problem, settings):
        return self._methods


def test_what_start_and_goal_decide_needs_no_method():
    def never(problem, log, until):
        pytest.fail("a method ran")

    table = Table(Method("never", anything, never))
    done = make_instance(name="done", blocks=["a"], stacks=["s1"], start={"s1": ["a"]}, goal=StacksGoal({"s1": ("a",)}))
    assert (table.plan(Problem(done), Settings(), 1).status, table.plan(Problem(done), Settings(), 1).cost) == (
        "optimal",
        0,
    )
    two = make_instance(
        name="two",
        blocks=["a", "b"],
        stacks=["s1", "s2"],
        start={"s1": ["a", "b"]},
        goal=StacksGoal({"s1": ("b", "a")}),
    )
    answer = table.plan(Problem(two, PlanOptions(topple=False)), Settings(), 1)
    assert (answer.status, answer.bound_origin) == ("infeasible", "feasibility")
    assert "two locations" in answer.details["reason"]


def test_the_kinds_of_aggregating_actions_are_asked_once_a_solve(monkeypatch):
    import smash.problem.rules as rules

    asked = []
    kinds_of = rules.kinds_of
    monkeypatch.setattr(rules, "kinds_of", lambda *args: asked.append(args) or kinds_of(*args))
    result = SmashPlanner().solve(read_instance(SCOOP), SolveOptions(), 5.0)
    assert result.actions is not None
    assert len(asked) == 1


def test_plan_options_without_settings_get_the_defaults():
    for name in ("smash", "greedy", "astar", "precedence", "smash-layered", "smash-flow"):
        result = get_planner(name).solve(swap(), PlanOptions(), 5)
        assert isinstance(result, PlanResult)
        assert result.cost == 5


def test_options_and_settings_come_apart_and_together_again():
    options = SolveOptions(True, 2, "greedy", 7, 3, 11, without=("lift",))
    assert plan_options(options) == PlanOptions(True, 2, without=("lift",))
    assert settings_of(options) == Settings("greedy", 7, 3, 11)
    assert SolveOptions.of(plan_options(options), settings_of(options)) == options
    assert settings_of(options).cold == Settings(None, None, 3, 11)


OUTSIDER = """
from smash.planners.demands import demands_of
from smash.planners.indexed import Indexed
from smash.planners.protocol import BasePlanner, IncumbentLog, OnIncumbent, PlanResult, SolveOptions
from smash.planners.gentle import gentle_topples
from smash.planners.protocol import why_unsupported
from smash.planners.registry import get_planner
from smash.planners.targets import target_piles
from smash.problem import Instance, Law, State
from smash.problem.family import is_plain, kinds_of
from smash.problem.instance_file import make_instance, read_instance
from smash.problem.suites import with_buffers
from smash.problem.topple import Topple
from smash.problem.model import Action

class Outsider(BasePlanner):
    summary = "written for 0.1"
    proves = True

    def solve(self, instance, options, budget, on_incumbent=None):
        log = IncumbentLog(instance, options, on_incumbent)
        impossible = log.without_plan()
        if impossible is not None:
            return impossible
        assert demands_of(instance).placed and target_piles(Indexed.of(instance))
        assert is_plain(instance, options) and gentle_topples(instance, ()) == ()
        assert why_unsupported(get_planner("greedy"), instance, options) is None
        law, queue, seen = Law(instance, options), [(State.start_of(instance), ())], set()
        for state, actions in queue:
            if law.goal_shortfall(state) is None:
                log.offer(actions, origin="outsider")
                log.prove(len(actions), origin="outsider")
                return log.result(details={"seed": options.seed})
            for action in list(law.legal_actions(state)):
                after = state.copy()
                law.apply(after, action)
                if after.key() not in seen:
                    seen.add(after.key())
                    queue.append((after, (*actions, action)))
        return log.result(infeasible=True, bound_origin="outsider")
"""


def test_a_planner_written_for_the_first_version_plans_unchanged():
    scope = {}
    exec(textwrap.dedent(OUTSIDER), scope)
    found = []
    told = lambda seconds, cost, actions: found.append(cost)  # noqa: E731
    plan = ask(scope["Outsider"](), Problem(swap()), Settings(seed=3), 5, told, name="outsider")
    assert (plan.planner, plan.status, plan.cost, plan.details["seed"]) == ("outsider", "optimal", 5, 3)
    assert found == [5]


def test_every_planner_that_is_registered_can_be_loaded_or_says_what_it_lacks():
    def solve_or_reason(name):
        try:
            return get_planner(name).solve
        except Unsupported as error:
            return str(error)

    for name in planner_names():
        found = solve_or_reason(name)
        assert callable(found) or found.startswith(f"planner {name!r} is not installed: "), found


def test_the_log_of_outsiders_answers_with_a_plan_result():
    log = IncumbentLog(swap(), PlanOptions(topple=False))
    first, second = log.result(details={"a": 1}), log.result(infeasible=True, details={"b": 2})
    assert (first.details, second.details) == ({"a": 1}, {"b": 2})
    assert log.result().status == "unknown"
    assert not log.offer((), "nothing")
    assert "goal not reached" in log.refusals[0]
    assert log.result(infeasible=True, bound_origin="me").bound_origin == "me"


def test_costs_of_a_plan_are_those_of_the_law():
    instance = make_instance(
        name="dear",
        blocks=["a"],
        stacks=["s1", "s2"],
        start={"s1": ["a"]},
        goal=StacksGoal({"s2": ("a",)}),
        costs=Costs({"pick": 5}),
    )
    plan = ask(get_planner("smash"), Problem(instance), Settings(), 2, name="smash")
    assert (plan.status, plan.cost, len(plan.actions)) == ("optimal", 6, 2)


def test_a_copy_of_a_problem_judges_as_the_problem_does():
    problem = Problem(swap())
    plan = [Topple("s1", 1), Pick("b", "table"), Place("b", "s1"), Pick("a", "table"), Place("a", "s1")]
    assert problem.law.check(plan).accepted
    for copied in (copy.deepcopy(problem), pickle.loads(pickle.dumps(problem))):
        assert copied == problem
        assert copied.law.check(plan).accepted
        assert copied.numbered.blocks == 2


def test_a_list_of_actions_from_outside_becomes_a_plan_like_any_other():
    class Lists(BasePlanner):
        def solve(self, instance, options, budget, on_incumbent=None):
            return PlanResult("feasible", [Topple("s1", 1)])

    assert ask(Lists(), Problem(swap()), Settings(), 1).actions == (Topple("s1", 1),)
