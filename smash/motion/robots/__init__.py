"""Robots as data: `smash-robot/1` and `smash-hand/1` files, their URDFs put together, and the robots that are shipped.

`load_robot(name_or_path)` gives the `Robot` of the package (`smash.motion.robot`) that everything else asks.
"""

from __future__ import annotations

from smash.motion.robots.loading import DEFAULT_ROBOT, load_robot, robot_names

__all__ = ["DEFAULT_ROBOT", "load_robot", "robot_names"]
