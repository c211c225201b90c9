"""The compiled functions do what the interpreted ones do."""

import dataclasses
import itertools

import pytest

from smash.planners.astar.compiled import INTERPRETED
from smash.planners.astar.engine import StoreEngine
from smash.planners.astar.search import EXPANDED, FLOOR, NODES, RUNNING, UPPER
from smash.planners.astar.task import make_setting
from smash.problem import OnGoal, PlanOptions
from smash.problem.sets.generators import generate
from smash.problem.views.numbered import Numbered


@pytest.mark.parametrize("topple", [True, False])
@pytest.mark.parametrize("goal", ["stacks", "on"])
def test_compiled_and_interpreted_searches_file_the_same_states(topple, goal, machine_code):
    instance = generate("multi", 6, buffers=1, seed=3)[0]
    if goal == "on":
        pairs = (pair for pile in instance.goal.stacks.values() for pair in itertools.pairwise(pile))
        instance = dataclasses.replace(instance, goal=OnGoal({upper: under for under, upper in pairs}))
    setting = make_setting(Numbered.of(instance), PlanOptions(topple))
    engines = [
        StoreEngine(setting, INTERPRETED, False),
        StoreEngine(setting, machine_code, True),
    ]
    for engine in engines:
        engine.open(3000, engine.first_bound(), 30)
        engine.share = 25
    for _ in range(6):
        outcomes = [engine.expand() for engine in engines]
        ours, theirs = (engine.store for engine in engines)
        assert outcomes[0] == outcomes[1]
        assert [engines[0].counter(c) for c in (NODES, UPPER, FLOOR, EXPANDED)] == [
            engines[1].counter(c) for c in (NODES, UPPER, FLOOR, EXPANDED)
        ]
        count = engines[0].counter(NODES) * engines[0].task.blocks
        assert list(ours.states[:count]) == list(theirs.states[:count])
        if outcomes[0] != RUNNING:
            break
