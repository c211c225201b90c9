import numpy as np

from smash.motion.obstacles import Scene
from smash.motion.poses import yaw_rotation

SIDE = 0.045


def tower_scene(heights):
    """Stacks at r 0.45 m at the given angles [rad], as high as given, on the table."""
    names, centres, rotations = [], [], []
    for angle, height in heights.items():
        for level in range(height):
            names.append(f"{angle:.1f}/{level}")
            centres.append([0.45 * np.cos(angle), 0.45 * np.sin(angle), SIDE * (level + 0.5)])
            rotations.append(yaw_rotation(angle))
    return Scene.of_boxes(names, centres, SIDE / 2, np.array(rotations)).with_table()
