"""Spheres that cover the links of an arm: the table that its file names, read, and made by `fit_spheres`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from smash.motion.robot import Robot
from smash.problem.errors import MalformedFile
from smash.problem.files.documents import read_text

HEADER = "link,x,y,z,radius"


def read_cover(robot: Robot) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the spheres of a robot, and which are whose.

    Returns:
        Centre and radius in the frames of `Robot.chain` [m], shape (S, 4); body i owns those from the i-th number on to
        the next, shape (n + 2,).

    Raises:
        MalformedFile: where the robot's file names no table, or it is not one of this robot's links.
    """
    if robot.spheres is None or not robot.spheres.is_file():
        said = "none is named" if robot.spheres is None else f"{robot.spheres} is not there"
        raise MalformedFile(str(robot.path), f"`arm.spheres`: {said}; `smash robot {robot.path} --fit` makes the table")
    where = str(robot.spheres)
    header, *lines = read_text(robot.spheres).splitlines() or [""]
    if header != HEADER:
        raise MalformedFile(where, f"the first line must be {HEADER}")
    of_body: list[list[NDArray[np.float64]]] = [[] for _ in range(robot.count + 1)]
    for number, line in enumerate(lines, start=2):
        link, *rest = line.split(",")
        try:
            x, y, z, radius = map(float, rest)
        except ValueError:
            raise MalformedFile(where, f"line {number}: a link and four numbers are allowed") from None
        if link not in robot.bodies:
            raise MalformedFile(where, f"line {number}: {link!r} is no link of the arm {robot.name!r}")
        body, placement = robot.in_body(link)
        of_body[body].append(np.array([*(placement[:3, :3] @ (x, y, z) + placement[:3, 3]), radius]))
    for body, spheres in enumerate(of_body):
        if body and not spheres:
            raise MalformedFile(where, f"no sphere for {robot.links[body - 1]!r}")
    first = np.concatenate([[0], np.cumsum([len(spheres) for spheres in of_body])]).astype(np.int64)
    return np.array([row for spheres in of_body for row in spheres]), first
