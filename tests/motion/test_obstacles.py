"""Boxes with names, and what the hand holds of them."""

import numpy as np
import pytest

from smash.motion.obstacles import FIXTURE, Attached, CarrierBody, Scene, in_words
from smash.motion.poses import top_down


def three():
    names = ["a", CarrierBody("a"), CarrierBody("a")]
    return Scene.of_boxes(names, [[0, 0, 1], [1, 0, 1], [2, 0, 1]], 0.1)


def test_the_table_ends_at_height_0_and_is_never_left_out():
    scene = three().with_table()
    assert scene.names[-1] is FIXTURE
    assert scene.centres[-1, 2] + scene.half_extents[-1, 2] == pytest.approx(0.0)
    assert scene.without(scene.names).names == (FIXTURE,)


def test_a_block_and_a_carrier_of_the_same_name_are_two_things():
    assert three().without(["a"]).names == (CarrierBody("a"), CarrierBody("a"))
    assert three().only_of([CarrierBody("a")]).centres[:, 0].tolist() == [1, 2]
    assert [in_words(name) for name in ("a", CarrierBody("a"), FIXTURE)] == ["block 'a'", "carrier 'a'", "the table"]


def test_one_number_is_the_half_of_all_sides():
    assert np.array_equal(three().half_extents, np.full((3, 3), 0.1))
    assert three().only(1).centres.tolist() == [[1, 0, 1]]
    assert three().none().names == ()


def test_what_is_held_is_as_far_from_the_tool_as_in_the_world():
    """The tool points down and is turned by a quarter: what lies ahead along y is along its x axis."""
    tool = top_down([0.0, 0.0, 1.2], np.pi / 2)
    held = Attached.of_scene(Scene.of_boxes(["b"], [[0.0, 0.3, 1.0]], 0.1), tool)
    assert held.translations[0] == pytest.approx([0.3, 0.0, 0.2])
    assert np.allclose(held.rotations[0], tool.rotation.T)


def test_a_held_cube_is_at_the_tool():
    held = Attached.cube(0.05)
    assert held.half_extents.tolist() == [[0.025] * 3]
    assert not held.translations.any()
