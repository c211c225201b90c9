"""What a MILP solver concludes beyond the costs that it was tested with is its claim, and proves nothing."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from smash.planners.milp import tested
from smash.planners.protocol import SOLVERS, Settings, SolveLog, ask
from smash.planners.registry import get_planner
from smash.problem.costs import Costs
from smash.problem.files.instances import read_instance
from smash.problem.problem import Problem

ROOT = Path(__file__).parents[3]
DEAR = Costs(actions={"pick": 1000, "place": 1000, "topple": 10})


def figure_1(costs):
    return Problem(replace(read_instance(ROOT / "examples" / "figure1.json"), costs=costs))


@pytest.mark.parametrize("planner", ["smash-layered", "smash-flow"])
@pytest.mark.parametrize("trusted", [True, False])
def test_an_optimum_beyond_the_tested_costs_is_a_claim(planner, trusted, monkeypatch):
    monkeypatch.setitem(tested.TESTED, "highs", 10**9 if trusted else 1000)
    plan = ask(get_planner(planner), figure_1(DEAR), Settings(), 20.0)
    assert plan.cost is not None
    assert plan.status == ("optimal" if trusted else "feasible")
    if trusted:
        assert "claimed" not in plan.details
    else:
        assert plan.details["claimed"]["lower_bound"] == plan.cost > (plan.lower_bound or 0)
        assert "proofs of highs are tested up to 1,000" in plan.details["claimed"]["not_believed"]


def test_where_every_action_costs_1_a_solver_is_believed(monkeypatch):
    monkeypatch.setitem(tested.TESTED, "highs", 0)
    assert ask(get_planner("smash-layered"), figure_1(Costs()), Settings(), 20.0).status == "optimal"


def test_a_claim_ends_the_search_and_raises_no_bound():
    log = SolveLog(figure_1(Costs()), worth=9)
    log.doubt = "not tested"
    log.prove(2, "moves")
    log.conclude(9, "milp")
    log.conclude_none("milp")
    assert (log.bound, log.refuted, log.settled) == (2, None, True)
    assert log.details["claimed"] == {"lower_bound": 9, "status": "infeasible", "not_believed": "not tested"}


def test_the_page_tells_the_tested_sums_of_every_solver():
    page = (ROOT / "docs" / "pddl.md").read_text()
    assert set(tested.TESTED) == set(SOLVERS)
    for solver, most in tested.TESTED.items():
        agreed = []
        for planner in ("smash-layered", "smash-flow"):
            row = rf"^\| `{planner}/{solver}` \| [\d,]+ \| ([\d,]+) \| \d+ \| [1-9]\d* \| 0 \|"
            agreed.append(max(int(found.replace(",", "")) for found in re.findall(row, page, re.MULTILINE)))
        assert min(agreed) == most
