"""Positions for costs of travel: bearings along an arc, distances from the base."""

import dataclasses
from math import pi

import pytest

from smash.execution.layout.unrolled import ARC, unrolled_positions
from smash.execution.scene.scene_file import default_scene
from smash.execution.scene.tabletop import Slot
from smash.problem import PositionsGoal, make_instance


def places(*slots, start=None):
    scene = dataclasses.replace(default_scene(), stacks=slots, buffers=())
    names = [f"s{number}" for number in range(len(slots))]
    instance = make_instance(name="i", blocks=["a"], stacks=names, start=start or {"s0": ["a"]}, goal=PositionsGoal({}))
    return unrolled_positions(scene, instance)


def test_a_place_is_its_bearing_along_the_arc_and_its_distance_from_the_base():
    found = places(Slot(0.4, 0.0, ("outward",)), Slot(0.5, pi / 2, ("outward",)), Slot(0.6, -pi / 2, ("outward",)))
    assert found["s0"] == pytest.approx((0.0, 0.4), abs=1e-3)
    assert found["s1"] == pytest.approx((ARC * pi / 2, 0.5), abs=1e-3)
    assert found["s2"] == pytest.approx((-ARC * pi / 2, 0.6), abs=1e-3)


def test_places_left_and_right_of_the_back_are_far_apart_as_the_hand_goes():
    found = places(Slot(0.4, pi - 0.1, ("outward",)), Slot(0.4, -pi + 0.1, ("outward",)))
    assert found["s0"][0] - found["s1"][0] == pytest.approx(ARC * (2 * pi - 0.2), abs=2e-3)


def test_the_table_region_is_where_the_filled_stacks_fall():
    """The only filled stack falls outward: the region is at its bearing, further out."""
    found = places(Slot(0.4, 0.5, ("outward",)), Slot(0.4, -0.5, ("outward",)))
    assert found["table"][0] == pytest.approx(found["s0"][0], abs=1e-3)
    assert found["table"][1] > 0.4


def test_where_no_filled_stack_is_toppled_the_region_is_where_the_others_fall():
    found = places(Slot(0.4, 0.5), Slot(0.4, -0.5, ("outward",)))
    assert found["table"][0] == pytest.approx(found["s1"][0], abs=1e-3)
    assert "table" not in places(Slot(0.4, 0.5), Slot(0.4, -0.5))
