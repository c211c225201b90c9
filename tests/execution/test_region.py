"""The table region: what lies on what, and where there is room."""

from dataclasses import replace
from math import hypot

import numpy as np
import pytest

from smash.execution.scene.block_pose import BlockPose, standing
from smash.execution.scene.block_size import BlockSize
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.region import REGION_APART, covering, free_places
from smash.execution.scene.scene_file import default_scene

SCENE = default_scene()
SIDE = SCENE.side


def lying(**places):
    """Poses of blocks at x, y and a level of the table region."""
    return {name: standing(x, y, (level + 0.5) * SIDE, 0.3) for name, (x, y, level) in places.items()}


def test_what_lies_on_a_block_or_on_what_does_is_named_from_the_top():
    poses = lying(a=(0.4, 0.1, 0), b=(0.42, 0.1, 1), c=(0.43, 0.11, 2), d=(0.46, 0.1, 0), e=(0.6, 0.1, 1))
    assert covering("a", set(poses), poses, SCENE) == ["c", "b"]
    assert covering("b", set(poses), poses, SCENE) == ["c"]
    assert covering("c", set(poses), poses, SCENE) == []
    assert covering("e", set(poses), poses, SCENE) == []


def test_what_stands_at_a_location_covers_nothing():
    poses = lying(a=(0.4, 0.1, 0), b=(0.42, 0.1, 1))
    assert covering("a", {"a"}, poses, SCENE) == []


def test_free_places_are_apart_from_all_and_the_nearest_comes_first():
    poses = lying(a=(0.4, -0.1, 0), b=(0.41, -0.1, 1), c=(0.45, 0.02, 0))
    where = Geometry({}, blocks=poses)
    places = free_places(SCENE, where, "b")
    others = [(pose.position[0], pose.position[1]) for name, pose in poses.items() if name != "b"]
    others += [(slot.x, slot.y) for slot in SCENE.slots]
    assert places
    assert all(hypot(x - ox, y - oy) > REGION_APART * SCENE.widest for x, y in places for ox, oy in others)
    away = [hypot(x - 0.41, y + 0.1) for x, y in places]
    assert away == sorted(away)


def test_where_all_is_full_there_is_no_place():
    crowd = {}
    for number, (x, y) in enumerate(free_places(SCENE, Geometry({}, blocks=lying(a=(9.0, 9.0, 0))), "a")):
        crowd[f"b{number}"] = standing(x, y, SIDE / 2, 0.0)
    assert not free_places(SCENE, Geometry({}, blocks=lying(a=(0.4, 0.1, 1)) | crowd), "a")


def test_a_box_that_lies_across_another_covers_it():
    boxes = replace(
        SCENE,
        sizes={
            "low": BlockSize(0.03, 0.07, 0.1),
            "top": BlockSize(0.03, 0.07, 0.1),
            "flat": BlockSize(0.06, 0.03, 0.1),
        },
    )
    flat = BlockPose(np.array([0.4, 0.1, 0.015]), np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]))
    across = BlockPose(np.array([0.41, 0.1, 0.045]), flat.rotation)
    assert covering("low", {"top"}, {"low": flat, "top": across}, boxes) == ["top"]
    poses = {"flat": standing(0.4, 0.1, 0.015, 0.0), "top": standing(0.44, 0.1, 0.065, 0.0)}
    assert covering("flat", {"top"}, poses, boxes) == ["top"]


@pytest.mark.slow
def test_a_pick_of_a_block_that_lies_under_another_sets_that_aside_in_the_open_pipeline():
    """Seven blocks fall in two topples: the second leaves one on another."""
    import smash

    instance = smash.suite("multi-9")[8]
    plan = smash.plan(instance, max_topple=4, budget=10)
    episode = smash.execute(instance, plan, replan=False, seed=0)
    assert episode.success
    assert sum(len(action.aside) for action in episode.actions) in (0, 1)
