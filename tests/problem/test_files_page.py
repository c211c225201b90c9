"""What `docs/files.md` shows is read, and what it says of it is true."""

import json
import re
from pathlib import Path

from smash.planners.astar import AStarPlanner
from smash.planners.protocol import Settings
from smash.problem import PlanOptions
from smash.problem.files.instances import instance_from_document
from smash.problem.files.plans import plan_from_document
from smash.problem.plan import check_plan
from smash.problem.problem import Problem

PAGE = Path(__file__).parents[2] / "docs" / "files.md"
THREE, ON_TABLE, IN_HAND, PLAN = map(json.loads, re.findall(r"```json\n(.*?)```", PAGE.read_text(), re.DOTALL))


def optimum(document, *, topple=True):
    problem = Problem(instance_from_document(document), PlanOptions(topple))
    answer = AStarPlanner().plan(problem, Settings(), 20.0)
    assert answer.status == "optimal"
    return answer.cost


def test_the_instances_have_the_costs_that_it_says():
    assert optimum(THREE) == 7
    assert (optimum(ON_TABLE), optimum(ON_TABLE, topple=False)) == (1, 6)
    assert optimum(IN_HAND) == 1


def test_its_plan_is_one():
    assert check_plan(instance_from_document(ON_TABLE), plan_from_document(PLAN)).accepted
