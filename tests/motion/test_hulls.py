"""The exact checker: what it sees, and what it calls it."""

import numpy as np
import pytest

from smash.motion import hulls
from smash.motion.hulls import CARRIED, HullChecker
from smash.motion.kinematics import inverse
from smash.motion.obstacles import Attached, HandState, Scene
from smash.motion.poses import top_down
from tests.motion.towers import tower_scene
from tests.robots import PANDA, READY

SIDE = 0.045
TABLE = Scene.of_boxes([], np.empty((0, 3)), 0.0).with_table()


def at_height(height):
    return inverse(PANDA, top_down([0.45, 0.0, height], 0.0))[0]


def test_fingers_in_the_table_are_a_contact_and_fingers_above_it_are_none():
    above, below = PANDA.hand.tip + 0.004, PANDA.hand.tip - 0.004
    assert HullChecker(PANDA, TABLE).contact(at_height(above)) is None
    contact = HullChecker(PANDA, TABLE).contact(at_height(below))
    assert contact.other == "the table"
    assert "finger" in contact.part


def test_the_first_contact_along_a_motion_says_where_on_it():
    rows = np.stack([at_height(height) for height in (0.2, 0.1, 0.0, -0.01)])
    assert HullChecker(PANDA, TABLE).contact(rows).step == 2


def test_a_box_may_be_entered_by_the_tolerance():
    joints = at_height(PANDA.hand.tip - 0.004)
    assert HullChecker(PANDA, TABLE, tolerance=0.006).contact(joints) is None


def test_what_is_carried_touches_what_the_hand_does_not():
    held = HandState(SIDE / 2, Attached.cube(SIDE))
    joints = at_height(SIDE / 2 - 0.005)
    assert HullChecker(PANDA, TABLE, HandState(SIDE / 2)).contact(joints) is None
    contact = HullChecker(PANDA, TABLE, held).contact(joints)
    assert {contact.part, contact.other} == {CARRIED, "the table"}


@pytest.mark.parametrize("name", ["b", "box 7"])
def test_a_block_around_the_hand_is_called_by_its_name(name):
    scene = Scene.of_boxes([name], [PANDA.forward(READY).position], 0.02)
    assert f"block {name!r}" in str(HullChecker(PANDA, scene).contact(READY))


@pytest.mark.parametrize("hand", [HandState(0.03), HandState(SIDE / 2, Attached.cube(SIDE))])
def test_what_the_spheres_leave_out_touches_nothing(hand, monkeypatch):
    scene = tower_scene({-1.0: 3, 0.0: 9, 0.6: 5, 2.0: 1})
    generator = np.random.default_rng(5)
    starts = generator.uniform(PANDA.lower, PANDA.upper, (60, PANDA.count))
    motions = [start + np.linspace(0.0, 0.5, 4)[:, None] * generator.normal(size=PANDA.count) for start in starts]
    found = [HullChecker(PANDA, scene, hand).contact(motion) for motion in motions]
    monkeypatch.setattr(hulls, "parts_near", lambda places, radii, pairs: np.ones(len(pairs), dtype=bool))
    everything = lambda places, radii, parts, centres, half, axes: np.ones((len(centres), len(parts)), dtype=bool)  # noqa: E731
    monkeypatch.setattr(hulls, "boxes_near", everything)
    assert found == [HullChecker(PANDA, scene, hand).contact(motion) for motion in motions]
    assert {None} < {contact and contact.other for contact in found}
