"""Plans are weighed: what planners are asked, and what is said of the plan that is chosen."""

from dataclasses import replace
from threading import Event
from types import SimpleNamespace

import msgspec
import pytest

import smash as door
from smash.experiments.isolation.job import Job, Report, still_running
from smash.experiments.sweeps.sweep import weighed_or_not
from smash.experiments.weighing.apart import NotChosen, Weighing, chosen_apart
from smash.experiments.weighing.choosing import Choice, Question, _Choosing, choose
from smash.experiments.weighing.weighed import weighed
from smash.forecast.expected import Forecaster
from smash.forecast.model import default_model
from smash.forecast.search import Candidate
from smash.planners.protocol import Settings, ask
from smash.planners.registry import UnknownPlanner, get_planner
from smash.problem.errors import Unsupported
from smash.problem.model import PlanOptions
from smash.problem.plan import Incumbent, Plan, check_plan
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


def asking(instance, *starts, **how):
    return Question(job(instance, **how), starts, spent=0.1, proven=True)


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
    assert plan.incumbents[-1].cost == min(plan.cost, optimum.cost)
    assert plan.details["weighed_seconds"] > 0.0
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


def test_robust_says_where_there_is_no_proof_and_leaves_the_planner_all_its_budget(instance):
    asked = Asked()
    plan = weighed(job(instance, "actions", robust=True, planner="greedy"), asked, ELSEWHERE).plan
    assert plan.details["note"] == "ties are not broken by risk: that takes a proven optimum"
    assert [part.budget for part in asked.jobs] == [2.0]


@pytest.mark.parametrize("how", [{"planner": "greedy"}, {"topple": False}], ids=["no proof", "no risk"])
def test_no_process_is_begun_where_no_ties_are_to_be_broken(instance, how):
    asked = job(instance, "actions", robust=True, **how)
    report = weighed(asked, Asked(), ELSEWHERE, choose_by=lambda question: pytest.fail("weighed"))
    assert report.plan.details["risk"] >= 0.0
    assert check_plan(instance, report.plan).accepted


class Slow:
    """A planner that has a plan from its n-th run on."""

    def __init__(self, needs, outcome="budget-spent"):
        self.needs, self.outcome, self.jobs = needs, outcome, []

    def __call__(self, part):
        self.jobs.append(part)
        if len(self.jobs) >= self.needs:
            plan = ask(get_planner("greedy"), part.problem, part.settings, part.budget, name="greedy")
            plan = replace(plan, incumbents=(Incumbent(0.2, plan.cost, "greedy"),))
            return Report("feasible", plan, wall_seconds=0.5, cpu_seconds=0.25, memory_mib=10.0)
        empty = Plan(part.instance.name, part.planner, part.options, "unknown", None, 3 - len(self.jobs), "x")
        reason = still_running(part.budget, part.budget) if self.outcome == "over-budget" else ""
        return Report(self.outcome, empty, reason, wall_seconds=part.budget, cpu_seconds=0.25, memory_mib=20.0)


def test_where_nothing_is_found_the_planner_goes_on_to_the_real_budget(instance):
    slow = Slow(needs=9, outcome="over-budget")
    report = weighed(job(instance), slow, ELSEWHERE)
    assert [part.options.topple for part in slow.jobs] == [True, False, True]
    assert (report.wall_seconds, report.cpu_seconds, report.memory_mib) == (pytest.approx(2.0), 0.75, 20.0)
    assert report.reason == "still running after 2.0 s on a budget of 2 s: stopped"
    assert (report.plan.status, report.plan.lower_bound) == ("unknown", 2)


def test_a_plan_that_is_found_late_is_weighed_and_the_trace_says_when_it_was_found(instance):
    slow = Slow(needs=3)
    report = weighed(job(instance, budget=4.0), slow, ELSEWHERE)
    assert check_plan(instance, report.plan).accepted
    assert report.plan.incumbents[0].seconds == pytest.approx(2.0 + 0.2)
    assert (report.plan.options.topple, report.cpu_seconds) == (True, 0.75)


def test_nothing_more_is_asked_of_a_run_that_is_stopped(instance):
    slow = Slow(needs=9)
    assert weighed(job(instance), slow, ELSEWHERE, lambda: len(slow.jobs) > 1).outcome == "budget-spent"
    assert len(slow.jobs) == 2


def test_no_motion_is_warmed_up_for_a_planner_that_there_is_not(instance, monkeypatch):
    monkeypatch.setattr("smash.experiments.weighing.weighed.ready", lambda question, model: pytest.fail("warmed up"))
    with pytest.raises(UnknownPlanner):
        weighed(job(instance, planner="nobody"), Asked(), None)


def test_every_action_without_a_motion_is_trouble(instance):
    forecaster = Forecaster(Problem(instance), default_model())
    actions = ask(get_planner("greedy"), Problem(instance), Settings(), 2.0, name="greedy").actions
    candidate = Candidate(actions, forecaster.of(actions))

    class Missed:
        def of(self, problem, actions, seed):
            return [SimpleNamespace(action=action, seconds=None) for action in actions]

    weighing = _Choosing(asking(instance, actions), forecaster, Missed(), 0.0, lambda: False)
    known = sum(step.seconds + (1 - step.risk) * default_model().trouble for step in forecaster.steps(actions))
    assert weighing._seconds(candidate, 0) == pytest.approx(known)
    assert known > len(actions) * default_model().trouble


@pytest.fixture(scope="module")
def start(instance):
    return ask(get_planner("smash"), Problem(instance), Settings(), 2.0, name="smash").actions


def test_a_process_of_its_own_is_told_all_that_there_is_to_know(instance, start):
    work = Weighing(asking(instance, start, start[:2]), ELSEWHERE)
    told = Weighing.from_document(msgspec.json.decode(msgspec.json.encode(work.document())))
    assert (told.question.starts, told.question.spent, told.question.proven) == ((start, start[:2]), 0.1, True)
    assert told.question.job.document() == work.question.job.document()
    assert told.model == ELSEWHERE
    assert work.budget > 2.0 - 0.1
    assert work.memory == work.question.job.memory


def test_plans_are_chosen_in_a_process_of_its_own_as_here(instance, start):
    question = asking(instance, start, objective="actions", robust=True)
    apart = chosen_apart(question, ELSEWHERE, None)
    here = choose(question, Forecaster(question.job.problem, ELSEWHERE), None)
    assert (apart.actions, apart.details["risk"]) == (here.actions, pytest.approx(here.details["risk"]))
    assert apart.expected_seconds is here.expected_seconds is None
    fastest = chosen_apart(asking(instance, start, budget=0.3), ELSEWHERE, None)
    assert fastest.expected_seconds > 0.0
    assert fastest.details["weighed"] == "by the outcome model alone"


def test_a_process_that_weighs_ends_where_it_is_stopped(instance, start):
    stop = Event()
    stop.set()
    with pytest.raises(NotChosen) as refusal:
        chosen_apart(asking(instance, start, budget=60.0), ELSEWHERE, stop)
    assert refusal.value.interrupted


@pytest.mark.parametrize(("interrupted", "outcome"), [(True, "interrupted"), (False, "crashed")])
def test_what_ends_the_weighing_is_the_end_of_the_run_and_its_plan_is_kept(instance, interrupted, outcome):
    def broken(question):
        raise NotChosen("weighing its plans: out of memory", interrupted)

    report = weighed(job(instance), Asked(), ELSEWHERE, choose_by=broken)
    assert (report.outcome, report.reason) == (outcome, "weighing its plans: out of memory")
    assert check_plan(instance, report.plan).accepted


def test_the_time_of_choosing_counts(instance):
    def third(question):
        return Choice(question.starts[0], 0.7, {}, 1.0)

    assert weighed(job(instance), Asked(), ELSEWHERE, choose_by=third).wall_seconds == pytest.approx(0.02 + 0.7)


def test_the_plan_without_topple_is_kept_where_it_is_the_only_one_and_weighing_fails(instance):
    def broken(question):
        raise NotChosen("weighing its plans: out of memory", interrupted=False)

    report = weighed(job(instance), Slow(needs=2), ELSEWHERE, choose_by=broken)
    assert (report.outcome, report.reason) == ("crashed", "weighing its plans: out of memory")
    assert check_plan(instance, report.plan).accepted


def test_no_process_is_begun_for_a_run_that_is_stopped(instance):
    asked = Asked()
    report = weighed(
        job(instance), asked, ELSEWHERE, lambda: bool(asked.jobs), choose_by=lambda question: pytest.fail("weighed")
    )
    assert report.outcome == "interrupted"
    assert check_plan(instance, report.plan).accepted
