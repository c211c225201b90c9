"""The committed examples say what the paper says."""

from pathlib import Path

import pytest

from smash.problem import PlanOptions
from smash.problem.files.instances import read_instance
from tests.oracle import optimal_cost

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize(("topple", "actions"), [(False, 8), (True, 3)])
def test_figure_1_takes_8_actions_without_topple_and_3_with(topple, actions):
    assert optimal_cost(read_instance(EXAMPLES / "figure1.json"), PlanOptions(topple=topple)) == actions
