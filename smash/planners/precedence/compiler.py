"""The compiled kernels of the precedence graph, made once a process."""

from __future__ import annotations

import math

import numpy as np

from smash.planners.compiling import CompiledOnce
from smash.planners.precedence.annealing import Annealing
from smash.planners.precedence.compiled import compiled_kernels
from smash.planners.precedence.cycles import CycleFinder
from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.ranks import RankFinder
from smash.planners.precedence.turns import turn_graph
from smash.problem.model import Instance, PlanOptions, StacksGoal
from smash.problem.problem import Problem


class GraphCompiler(CompiledOnce):
    """The compiled kernels of this process (`compiled.Kernels`)."""

    @classmethod
    def _compile(cls) -> None:
        """Call every kernel once, on two blocks that change places."""
        start, goal = {"s": ("a",), "t": ("b",)}, StacksGoal({"s": ("b",), "t": ("a",)})
        instance = Instance("warm", ("a", "b"), ("s", "t"), ("u",), {**start, "u": ()}, goal, ())
        graph = build_graph(Problem(instance, PlanOptions(topple=False)))
        kernels = compiled_kernels()
        finder = CycleFinder(graph)
        finder.use(kernels)
        cycles = finder.violated(np.zeros(2), 1.0)
        turns = turn_graph(graph)
        assert turns is not None
        Annealing(turns, kernels, 1).run(1, math.inf)
        RankFinder(turns, kernels).violated(np.zeros(2), [graph.row(cycle) for cycle in cycles], 4, 0.5)
        cls._code = kernels
