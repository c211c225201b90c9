"""The demonstration of the scoop, small: two stacks and a tray on the left, two places on the right."""

from pathlib import Path

from smash.execution.scene.scene_file import read_scene
from smash.problem import Carrier, PositionsGoal, make_instance

ROOT = Path(__file__).parents[2]


def scoop_scene():
    return read_scene(ROOT / "examples" / "scoop-scene.toml")


def scoop(**changes):
    arguments = {
        "name": "scoop",
        "blocks": ["a", "b", "c", "d"],
        "stacks": ["s1", "s2", "g1", "g2"],
        "start": {"s1": ["a", "b"], "s2": ["c", "d"]},
        "goal": PositionsGoal({"a": ("g1", 1), "c": ("g2", 1)}),
        "carriers": [Carrier("tray", ("left", "right"), "left", 2)],
    }
    return make_instance(**arguments | changes)
