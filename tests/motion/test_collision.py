from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from smash.motion import kernel
from smash.motion.collision import CollisionChecker, arm_model
from smash.motion.fit_spheres import surface_samples
from smash.motion.hulls import HullChecker, link_vertices
from smash.motion.obstacles import Attached, HandState, Scene
from tests.motion.towers import SIDE, tower_scene
from tests.robots import PANDA, READY

TOWERS = tower_scene({-1.7: 4, -0.5: 5, 0.7: 9})
HAND = HandState(SIDE / 2, Attached.cube(SIDE))


def configurations(count, seed):
    return np.random.default_rng(seed).uniform(PANDA.lower, PANDA.upper, (count, 7))


def test_both_kinematics_agree():
    for joints in configurations(20, 0):
        frames = kernel.link_frames(arm_model(PANDA).chain, joints)
        pose = PANDA.forward(joints)
        assert np.allclose(frames[8, :, 3], pose.position)
        assert np.allclose(frames[8, :, :3], pose.rotation)


@pytest.mark.parametrize("link", range(8))
def test_the_spheres_cover_the_hull_of_their_link(link):
    model = arm_model(PANDA)
    own = model.spheres[model.first[link] : model.first[link + 1]]
    points = surface_samples(link_vertices(PANDA, f"panda_link{link}"), 2000, np.random.default_rng(7))
    outside = np.linalg.norm(points[:, None] - own[None, :, :3], axis=2) - own[None, :, 3]
    assert outside.min(axis=1).max() < 0.002
    assert ConvexHull(link_vertices(PANDA, f"panda_link{link}")).volume > 0


def test_no_collision_of_the_hulls_with_the_scene_is_missed():
    checker, hulls = CollisionChecker(PANDA, TOWERS, HAND, margin=0.0), HullChecker(PANDA, TOWERS, HAND, tolerance=0.0)
    missed = [joints for joints in configurations(600, 1) if checker.free(joints) and hulls.contact(joints)]
    assert missed == []


def test_what_is_free_with_a_margin_is_free_without():
    near, far = CollisionChecker(PANDA, TOWERS, HAND, margin=0.0), CollisionChecker(PANDA, TOWERS, HAND, margin=0.01)
    for joints in configurations(200, 2):
        assert far.slack(joints) <= near.slack(joints)


def test_a_segment_is_free_exactly_where_all_of_a_dense_sample_is():
    checker = CollisionChecker(PANDA, TOWERS, HAND)
    free = [joints for joints in configurations(120, 3) if checker.free(joints)]
    verdicts = set()
    for begin, end in pairwise(free):
        dense = all(checker.free(begin + part * (end - begin)) for part in np.linspace(0, 1, 400))
        verdict = checker.segment_free(begin, end)
        verdicts.add(verdict)
        assert dense or not verdict
    assert verdicts == {True, False}


def test_a_polyline_is_free_exactly_where_each_of_its_segments_is():
    checker, verdicts = CollisionChecker(PANDA, TOWERS, HAND), set()
    generator = np.random.default_rng(4)
    for start in configurations(150, 4):
        corners = start + np.cumsum(generator.normal(0.0, 0.1, (4, PANDA.count)), axis=0)
        verdict = checker.path_free(corners)
        verdicts.add(verdict)
        assert verdict == all(checker.segment_free(begin, end) for begin, end in pairwise(corners))
        assert not verdict or all(checker.segment_reach(begin, end) == 1.0 for begin, end in pairwise(corners))
    assert verdicts == {True, False}


def test_blockers_are_named_and_ignored_blocks_are_not():
    block = Scene.of_boxes(["b"], [PANDA.forward(READY).position], 0.02)
    assert CollisionChecker(PANDA, block).blockers(READY) == ("block 'b'",)
    assert CollisionChecker(PANDA, block.without(["b"])).free(READY)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6))
def test_the_distance_of_boxes_is_a_lower_bound_that_sees_every_overlap(seed):
    generator = np.random.default_rng(seed)
    half = generator.uniform(0.02, 0.2, (2, 3))
    centres = generator.uniform(-0.25, 0.25, (2, 3))
    axes = [np.linalg.qr(generator.normal(size=(3, 3)))[0] for _ in range(2)]
    boxes = (centres, half, np.stack(axes))
    bound = kernel.box_to_box(*boxes, 0, *boxes, 1, np.inf, np.empty((3, 3)))
    points = [centres[box] + (generator.uniform(-1, 1, (300, 3)) * half[box]) @ axes[box].T for box in range(2)]
    nearest = np.linalg.norm(points[0][:, None] - points[1][None], axis=2).min()
    assert bound <= nearest
    inside = np.abs((points[0] - centres[1]) @ axes[1]) <= half[1]
    if inside.all(axis=1).any():
        assert bound <= 0
