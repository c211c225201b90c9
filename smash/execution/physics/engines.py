"""The engines that there are, and which one simulates an episode.

An engine is a `World` in a file of its own, imported when it is asked for. To add one: write its file, a case in
`world_of`, and a line in `smash.problem.extras.ENGINES`.
"""

from __future__ import annotations

from smash.execution.physics.world import World
from smash.execution.scene.tabletop import Tabletop
from smash.problem.extras import default_engine, require_engine


def engine_of(tabletop: Tabletop, engine: str | None = None) -> str:
    """Return the engine that is used in a scene: the one that is named, else the scene's, else the one that is there.

    Raises:
        MissingExtra: where it is not installed.
        SmashError: where there is none of that name.
    """
    used = engine or tabletop.engine or default_engine()
    require_engine(used)
    return used


def world_of(engine: str) -> type[World]:
    """Return the world of an engine that is there, to be opened."""
    if engine == "mujoco":
        from smash.execution.physics.mujoco_world import MujocoWorld

        return MujocoWorld
    from smash.execution.physics.pybullet_world import PyBulletWorld

    return PyBulletWorld
