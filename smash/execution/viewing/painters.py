"""Which stage there is to draw pictures on.

PyBullet's software renderer paints wherever PyBullet is installed; elsewhere MuJoCo does, which needs OpenGL without a
window (EGL or OSMesa). Pictures are of what was recorded: which engine simulated it makes no difference.
"""

from __future__ import annotations

from smash.execution.viewing.stage import Stage
from smash.problem.extras import is_there


def stage_class() -> type[Stage]:
    """Return what paints here: PyBullet's stage where it is installed, else MuJoCo's."""
    if is_there("pybullet"):
        from smash.execution.viewing.pybullet_stage import PyBulletStage

        return PyBulletStage
    from smash.execution.viewing.mujoco_stage import MujocoStage

    return MujocoStage


def require_painter() -> None:
    """Refuse pictures that nothing can paint, before an episode is carried out for them.

    Raises:
        Unsupported: where MuJoCo would paint and there is no OpenGL.
    """
    if not is_there("pybullet"):
        from smash.execution.viewing.mujoco_stage import open_context

        open_context((1, 1)).free()
