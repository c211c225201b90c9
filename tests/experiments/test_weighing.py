"""Plans are weighed: what planners are asked, and what is said of the plan that is chosen."""

import msgspec
import pytest

import smash as door
from smash.experiments.isolation.job import Job, Report
from smash.experiments.sweeps.sweep import weighed_or_not
from smash.experiments.weighing import weighed
from smash.forecast.model import default_model
from smash.planners.protocol import Settings, ask
from smash.planners.registry import get_planner
from smash.problem.errors import Unsupported
from smash.problem.model import PlanOptions
from smash.problem.plan import check_plan
from smash.problem.problem import Problem

ELSEWHERE = msgspec.structs.replace(default_model(), layout="another")
"""A model that no rehearsal fits, so that the forecast stands alone."""


@pytest.fixture(scope="module")
def instance():
    return door.suite("multi-6")[0]


def job(instance, objective="seconds", robust=False, planner="smash", topple=True, budget=2.0):
    settings = Settings(objective=objective, robust=robust)
    return Job(planner, Problem(instance, PlanOptions(topple)), settings, budget)


class Asked:
    """Runs planners here, and keeps what they were asked."""

    def __init__(self, outcome=None):
        self.jobs, self.outcome = [], outcome

    def __call__(self, part):
        self.jobs.append(part)
        plan = ask(get_planner(part.planner), part.problem, part.settings, part.budget, name=part.planner)
        return Report(self.outcome or plan.status, plan, wall_seconds=0.01)


def test_the_plan_without_topple_is_among_the_choices(instance):
    asked = Asked()
    report = weighed(job(instance), asked, ELSEWHERE)
    assert [part.options.topple for part in asked.jobs] == [True, False]
    assert {part.settings.objective for part in asked.jobs} == {"actions"}
    assert sum(part.budget for part in asked.jobs) <= 2.0
    assert check_plan(instance, report.plan).accepted
    assert report.plan.expected_seconds > 0


def test_cost_bound_and_status_speak_of_actions(instance):
    asked = Asked()
    plan = weighed(job(instance), asked, ELSEWHERE).plan
    optimum = ask(get_planner("smash"), Problem(instance), Settings(), 2.0, name="smash")
    assert plan.cost == len(plan.actions) >= plan.lower_bound == optimum.cost
    assert plan.status == ("optimal" if plan.cost == optimum.cost else "feasible")
    assert plan.incumbents[-1].cost == plan.cost
    costs = [entry.cost for entry in plan.incumbents]
    assert costs == sorted(set(costs), reverse=True)


def test_a_planner_that_proves_nothing_leaves_a_plan_for_seconds_feasible(instance):
    plan = weighed(job(instance, planner="greedy"), Asked(), ELSEWHERE).plan
    assert plan.status == "feasible"


def test_without_topple_the_planner_is_asked_once(instance):
    asked = Asked()
    report = weighed(job(instance, topple=False), asked, ELSEWHERE)
    assert len(asked.jobs) == 1
    assert check_plan(instance, report.plan).accepted


def test_a_run_that_failed_is_reported_as_it_is(instance):
    assert weighed(job(instance), Asked("crashed"), ELSEWHERE).outcome == "crashed"


def test_a_run_that_is_stopped_keeps_what_it_has(instance):
    report = weighed(job(instance), Asked(), ELSEWHERE, lambda: True)
    assert report.outcome == "interrupted"
    assert check_plan(instance, report.plan).accepted


def test_what_the_model_does_not_know_is_refused_before_the_planner_is_asked():
    wide = door.make_instance(start={f"s{n}": [f"b{n}"] for n in range(6)}, goal={"s1": [f"b{n}" for n in range(6)]})
    asked = Asked()
    with pytest.raises(Unsupported):
        weighed(job(wide), asked, None)
    assert not asked.jobs
    assert weighed_or_not(job(wide), None).outcome == "unsupported"


def test_robust_keeps_cost_and_proof(instance):
    report = weighed(job(instance, "actions", robust=True), Asked(), ELSEWHERE)
    assert report.plan.status == "optimal"
    assert report.plan.details["risk"] <= report.plan.details["risk_before"]
    assert report.plan.expected_seconds is None
    assert check_plan(instance, report.plan).accepted


def test_robust_says_where_there_is_no_proof(instance):
    plan = weighed(job(instance, "actions", robust=True, planner="greedy"), Asked(), ELSEWHERE).plan
    assert "proven optimum" in plan.details["note"]
