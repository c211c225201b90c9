"""Shapes that a robot collides by, as pinocchio and coal read them: hulls, and the corners of these."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import coal
import numpy as np
import pinocchio
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from smash.motion.quiet import first_complaint, overheard
from smash.motion.robot import Robot
from smash.problem.errors import MalformedFile

MOST_TRIANGLES = 1400
"""A mesh of more is drawn by its hull."""


def shapes(model: Any, urdf: str, where: str) -> Any:
    """Return pinocchio's geometry of a URDF, every mesh as its convex hull.

    Raises:
        MalformedFile: where a mesh cannot be read.
    """
    with overheard():
        try:
            geometry = pinocchio.buildGeomFromUrdfString(model, urdf, pinocchio.GeometryType.COLLISION)
        except (ValueError, RuntimeError) as error:
            reason = first_complaint(str(error), "")
            raise MalformedFile(where, f"a mesh cannot be read: {reason}") from None
    for part in geometry.geometryObjects:
        if isinstance(part.geometry, coal.BVHModelBase):
            part.geometry.buildConvexHull(True, "Qt")
            part.geometry = part.geometry.convex
    return geometry


def link_of(part: Any) -> str:
    """Return the link that a shape belongs to: pinocchio numbers the shapes of each."""
    return str(part.name).rpartition("_")[0]


def corners(part: Any) -> NDArray[np.float64]:
    """Return the corners of a shape in its own frame [m], shape (V, 3); of a round one, those of the box around it."""
    if isinstance(part.geometry, coal.ConvexBase):
        return np.array([part.geometry.point(index) for index in range(part.geometry.num_points)])
    return box_corners(part.geometry)


def box_corners(shape: Any) -> NDArray[np.float64]:
    """Return the corners of the box around a shape in its own frame [m], shape (8, 3)."""
    shape.computeLocalAABB()
    low, high = np.asarray(shape.aabb_local.min_).ravel(), np.asarray(shape.aabb_local.max_).ravel()
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])


def link_points(model: Any, urdf: str, data: Any, links: Collection[str], where: str) -> NDArray[np.float64]:
    """Return the corners of all shapes of some links in the world, where `data` has the joints [m], shape (V, 3).

    Raises:
        MalformedFile: where they have none.
    """
    geometry, found = shapes(model, urdf, where), []
    for part in geometry.geometryObjects:
        if link_of(part) in links:
            placed = (data.oMi[part.parentJoint] * part.placement).homogeneous
            found.append(corners(part) @ placed[:3, :3].T + placed[:3, 3])
    if not found:
        raise MalformedFile(where, f"{' and '.join(sorted(links))} have no `collision` to make `boxes` of")
    return np.vstack(found)


def drawn_parts(robot: Robot) -> list[NDArray[np.float64]]:
    """Return what a robot looks like: triangles of base, arm links, hand and fingers in their frames.

    Returns:
        n + 4 arrays of shape (T, 9) [m]: base, what each joint moves, palm, first and second finger.
    """
    model = pinocchio.buildModelFromXML(robot.urdf)
    geometry = pinocchio.buildGeomFromUrdfString(model, robot.urdf, pinocchio.GeometryType.COLLISION)
    hand = robot.hand
    parts: list[list[NDArray[np.float64]]] = [[] for _ in range(robot.count + 4)]
    root = model.frames[model.getFrameId(hand.root, pinocchio.FrameType.BODY)].placement
    for part in geometry.geometryObjects:
        link, place = link_of(part), part.placement
        if link in hand.fingers:
            number = robot.count + 2 + hand.fingers.index(link)
        elif link in hand.links:
            number, place = robot.count + 1, root.actInv(place)
        else:
            number = robot.bodies[link]
        placed = place.homogeneous
        points = _triangles(part.geometry).reshape(-1, 3) @ placed[:3, :3].T + placed[:3, 3]
        parts[number].append(points.reshape(-1, 9))
    return [np.vstack(found) if found else np.empty((0, 9)) for found in parts]


def is_closed(triangles: NDArray[np.float64]) -> bool:
    """Tell whether triangles [m], shape (T, 9), leave no hole: each edge belongs to a neighbour the other way round."""
    places = np.round(triangles.reshape(-1, 3), 6)
    corners_of = np.unique(places, axis=0, return_inverse=True)[1].reshape(-1, 3)
    edges = np.vstack([corners_of[:, [0, 1]], corners_of[:, [1, 2]], corners_of[:, [2, 0]]])
    known = set(map(tuple, edges[edges[:, 0] != edges[:, 1]].tolist()))
    return all((end, start) in known for start, end in known)


def _triangles(shape: Any) -> NDArray[np.float64]:
    """The triangles of a shape [m], shape (T, 9): of its mesh; of its hull where that has holes or is too fine."""
    if isinstance(shape, coal.BVHModelBase) and shape.num_tris <= MOST_TRIANGLES:
        points, rows = np.array(shape.vertices()), [shape.tri_indices(index) for index in range(shape.num_tris)]
        triangles = np.asarray(points[np.array([[row[0], row[1], row[2]] for row in rows])].reshape(-1, 9))
        if is_closed(triangles):
            return triangles
    points = np.array(shape.vertices()) if isinstance(shape, coal.BVHModelBase) else box_corners(shape)
    hull = ConvexHull(points)
    first, second, third = (points[hull.simplices[:, corner]] for corner in range(3))
    turned = np.einsum(
        "ij,ij->i",
        np.cross(second - first, third - first),
        hull.equations[:, :3],
    )
    faces = np.where(turned[:, None] > 0, hull.simplices, hull.simplices[:, ::-1])
    return np.asarray(points[faces].reshape(-1, 9))
