"""Cover the hulls of a robot's links with spheres, once: `smash robot FILE --fit` writes the table that its file names.

Greedy set cover: candidates are spheres centred inside a hull that reach `Robot.padding` beyond its nearest face; they
are taken by how many of the still uncovered samples (hull surface, corners, inside) they cover. So every point of a
hull lies in a sphere, and no sphere stands out by more than the padding: the checker errs on the safe side.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from smash.motion.covers import HEADER
from smash.motion.hulls import link_vertices
from smash.motion.robot import Robot

SURFACE_SAMPLES = 6000
INSIDE_SAMPLES = 1500
CANDIDATES = 8000


def surface_samples(vertices: NDArray[np.float64], count: int, generator: np.random.Generator) -> NDArray[np.float64]:
    """Points spread uniformly over the hull of `vertices` and its corners, shape (count + corners, 3) [m]."""
    hull = ConvexHull(vertices)
    corners = vertices[hull.simplices]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    chosen = corners[generator.choice(len(corners), count, p=area / area.sum())]
    weights = generator.dirichlet(np.ones(3), count)
    return np.vstack([np.einsum("ni,nij->nj", weights, chosen), vertices[hull.vertices]])


def inside_samples(
    vertices: NDArray[np.float64], count: int, generator: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points inside the hull and their distance to its nearest face: shapes (count, 3) and (count,) [m]."""
    equations = ConvexHull(vertices).equations
    box = generator.uniform(vertices.min(axis=0), vertices.max(axis=0), (count * 6, 3))
    depth = -(box @ equations[:, :3].T + equations[:, 3]).max(axis=1)
    inside = depth > 0
    return box[inside][:count], depth[inside][:count]


def cover(vertices: NDArray[np.float64], padding: float, seed: int = 0) -> NDArray[np.float64]:
    """Spheres that cover the hull of `vertices` [m]: centre and radius, shape (S, 4)."""
    generator = np.random.default_rng(seed)
    centres, depth = inside_samples(vertices, CANDIDATES, generator)
    points = np.vstack([surface_samples(vertices, SURFACE_SAMPLES, generator), centres[:INSIDE_SAMPLES]])
    distance = np.linalg.norm(centres[:, None, :].astype(np.float32) - points[None].astype(np.float32), axis=2)
    covers = distance <= (depth + padding - 0.0005)[:, None]
    open_points = covers.any(axis=0)
    chosen: list[int] = []
    while open_points.any():
        best = int(covers[:, open_points].sum(axis=1).argmax())
        chosen.append(best)
        open_points &= ~covers[best]
    return np.column_stack([centres[chosen], depth[chosen] + padding])


def fitted(robot: Robot) -> str:
    """Return the table of spheres of a robot: link, x, y, z, radius [m] in the link's frame."""
    lines = [HEADER]
    for link, body in robot.bodies.items():
        vertices = link_vertices(robot, link)
        for x, y, z, radius in cover(vertices, robot.padding[body]) if len(vertices) else ():
            lines.append(f"{link},{x:.4f},{y:.4f},{z:.4f},{radius:.4f}")
    return "\n".join(lines) + "\n"
