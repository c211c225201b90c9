"""Compile what is compiled, once, so that no solve waits for it: `python -m smash.planners.astar.warm`."""

from __future__ import annotations

from smash.planners.astar.compiler import warm_up

if __name__ == "__main__":
    warm_up()
