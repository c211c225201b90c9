"""The compiled functions do what the interpreted ones do; old machine code is thrown away."""

import dataclasses
import itertools
import os
import threading
from time import perf_counter

import pytest

from smash.planners.astar import compiled, compiler
from smash.planners.astar.compiled import INTERPRETED
from smash.planners.astar.compiler import Compiler
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


def test_the_machine_code_is_waited_for_no_longer_than_the_deadline(monkeypatch):
    there = threading.Event()

    def slow():
        there.wait()
        return None

    monkeypatch.setattr(Compiler, "_thread", None)
    monkeypatch.setattr(Compiler, "_code", None)
    monkeypatch.setattr(Compiler, "_compile", slow)
    assert not Compiler.started()
    assert Compiler.code(0.0) is None
    assert Compiler.started()
    there.set()
    Compiler._thread.join()


def test_it_is_compiled_once_a_process(monkeypatch):
    begun = []

    def quick():
        begun.append(True)
        Compiler._code = INTERPRETED

    monkeypatch.setattr(Compiler, "_thread", None)
    monkeypatch.setattr(Compiler, "_code", None)
    monkeypatch.setattr(compiler.Compiler, "_compile", quick)
    assert Compiler.code(perf_counter() + 110) is Compiler.code(0.0) is INTERPRETED
    assert begun == [True]


def test_machine_code_older_than_a_source_is_dropped(monkeypatch, tmp_path):
    cache = tmp_path / "__pycache__"
    cache.mkdir()
    for name, age in (("source.py", 100), ("__pycache__/old.nbi", 50), ("__pycache__/new.nbi", 150)):
        (tmp_path / name).touch()
        os.utime(tmp_path / name, (age, age))
    source = type("Module", (), {"__file__": str(tmp_path / "source.py")})
    monkeypatch.setattr(compiled, "MODULES", (source,))
    compiled._drop_stale_cache()
    assert [file.name for file in cache.iterdir()] == ["new.nbi"]
