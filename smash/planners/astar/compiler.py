"""Compiling once a process, in a thread: the first time ever it takes long, and budgets are kept meanwhile."""

from __future__ import annotations

import threading
from time import perf_counter

from smash.planners.astar.compiled import Code, compiled_code
from smash.planners.astar.engine import StoreEngine
from smash.planners.astar.store import filled
from smash.planners.astar.task import make_setting
from smash.problem.model import Instance, PlanOptions, StacksGoal
from smash.problem.views.numbered import Numbered


class Compiler:
    """The compiled functions of this process."""

    _thread: threading.Thread | None = None
    _code: Code | None = None

    @classmethod
    def code(cls, deadline: float) -> Code | None:
        """Return the compiled functions, ready to run, or None where `deadline` passes before they are."""
        if cls._thread is None:
            cls._thread = threading.Thread(target=cls._compile, daemon=True)
            cls._thread.start()
        cls._thread.join(max(0.0, deadline - perf_counter()))
        return cls._code

    @classmethod
    def started(cls) -> bool:
        """Return whether compiling has begun."""
        return cls._thread is not None

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
        engine.code.file_node(engine.task, engine.cells, engine.store, -1, 0, -1, 0, 0)
        cls._code = engine.code


def warm_up() -> None:
    """Compile the search, so that its machine code is cached."""
    Compiler._compile()
