"""Compile what is compiled, once, so that no solve waits for it: `python -m smash.planners.warm`."""

from __future__ import annotations

from smash.planners.astar.compiler import Compiler
from smash.planners.precedence.compiler import GraphCompiler

if __name__ == "__main__":
    Compiler.warm_up()
    GraphCompiler.warm_up()
