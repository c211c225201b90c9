"""A proof of an engine beyond the numbers that it was tested with is its claim, and proves nothing."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from smash_baselines.engine import EnginePlanner
from smash_baselines.engines import tested
from smash_baselines.engines.outcomes import Outcome

from smash.planners.protocol import Settings
from smash.problem.costs import Costs
from smash.problem.files.instances import read_instance
from smash.problem.model import PlanOptions
from smash.problem.problem import Problem

ROOT = Path(__file__).parents[2]
DEAR = Costs(actions={"pick": 1000, "place": 1000, "topple": 10})


class Boasting(EnginePlanner):
    """Says of every problem what it is told to say."""

    name = "boasting"
    encoding = "chain"
    bound = None

    def run(self, run):
        if self.bound is None:
            run.infeasible = True
        else:
            run.raise_bound(self.bound)
        return Outcome("solved", "said so")


def said(bound, costs):
    planner = Boasting()
    planner.bound = bound
    instance = replace(read_instance(ROOT / "examples" / "figure1.json"), costs=costs)
    return planner.plan(Problem(instance, PlanOptions()), Settings(), 5.0)


@pytest.mark.parametrize("trusted", [True, False])
def test_a_bound_beyond_the_tested_costs_is_a_claim(trusted, monkeypatch):
    monkeypatch.setitem(tested.TESTED, "boasting", 10**9 if trusted else 1000)
    plan = said(7, DEAR)
    assert plan.lower_bound == (7 if trusted else None)
    assert ("claimed" in plan.details) != trusted
    if not trusted:
        assert plan.details["claimed"]["lower_bound"] == 7
        assert "tested up to 1,000" in plan.details["claimed"]["not_believed"]


def test_that_there_is_no_plan_is_a_claim_there_too():
    plan = said(None, DEAR)
    assert plan.status == "unknown"
    assert plan.details["claimed"]["status"] == "infeasible"


def test_where_every_action_costs_1_an_engine_is_believed():
    assert said(3, Costs()).lower_bound == 3
    assert said(None, Costs()).status == "infeasible"


def test_the_page_tells_the_tested_sums():
    page = (ROOT / "docs" / "pddl.md").read_text()
    for engine, most in tested.TESTED.items():
        rows = re.findall(rf"^\| `{engine}` \| [\d,]+ \| ([\d,]+) \| \d+ \| [1-9]\d* \| 0 \|", page, re.MULTILINE)
        assert max(int(row.replace(",", "")) for row in rows) == most
