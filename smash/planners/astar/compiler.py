"""The compiled functions of the search, made once a process."""

from __future__ import annotations

import math

from smash.planners.astar.compiled import compiled_code
from smash.planners.astar.engine import StoreEngine
from smash.planners.astar.pattern_sets import PatternBuilder
from smash.planners.astar.store import filled
from smash.planners.astar.task import make_setting
from smash.planners.compiling import CompiledOnce
from smash.problem.model import Instance, PlanOptions, StacksGoal
from smash.problem.views.numbered import Numbered


class Compiler(CompiledOnce):
    """The compiled functions of this process (`compiled.Code`)."""

    @classmethod
    def _compile(cls) -> None:
        """Call every function once, on a problem of one block."""
        goal = StacksGoal({"s": ("b",)})
        instance = Instance("warm", ("b",), ("s",), (), {"s": ()}, goal, ("b",))
        problem = Numbered.of(instance)
        setting = make_setting(problem, PlanOptions())
        assert setting is not None
        engine = StoreEngine(setting, compiled_code(), True)
        engine.open(4, 0, engine.first_bound() + 1)
        engine.expand()
        engine.steps(problem, engine.path())
        engine.code.apply_move(engine.task, engine.cells, 0, -1)
        engine.code.file_again(engine.task, engine.store)
        numbers = filled([0], True)
        engine.code.expand_layer(engine.task, engine.cells, engine.start_row(), numbers, numbers, engine.store, 0, 0)
        PatternBuilder(problem, engine.code).table((0,), math.inf)
        engine.code.file_node(engine.task, engine.cells, engine.store, -1, 0, -1, 0, 0)
        cls._code = engine.code
