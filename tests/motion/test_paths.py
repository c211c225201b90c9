"""Joint polylines: their length, points close together on them, rounded corners."""

import numpy as np
import pytest

from smash.motion.paths import LONGEST_BLEND, Path, densify, round_corners


def corner(first=1.0, second=1.0):
    """Along joint 1, then along joint 2 [rad]."""
    points = np.zeros((3, 7))
    points[1:, 0] = first
    points[2, 1] = second
    return points


def test_a_path_is_as_long_as_its_segments_and_walked_backwards_from_its_end():
    path = Path(corner(3.0, 4.0), "tree")
    assert path.length == 7.0
    back = path.reversed()
    assert np.array_equal(back.start, path.end)
    assert np.array_equal(back.end, path.start)
    assert back.length == path.length


@pytest.mark.parametrize("step", [0.3, 0.5, 5.0])
def test_no_joint_moves_further_than_the_step_and_corners_are_kept(step):
    points = densify(corner(), step)
    assert np.abs(np.diff(points, axis=0)).max() <= step + 1e-12
    assert all(np.isclose(points, row).all(axis=1).any() for row in corner())
    assert np.linalg.norm(np.diff(points, axis=0), axis=1).sum() == pytest.approx(2.0)


def test_points_of_a_segment_are_evenly_spaced_and_one_point_stays_one():
    points = densify(corner(1.0, 0.35), 0.3)
    assert points[:, :2] == pytest.approx(
        np.array([[0, 0], [0.25, 0], [0.5, 0], [0.75, 0], [1, 0], [1, 0.175], [1, 0.35]])
    )
    assert np.array_equal(densify(corner()[:1], 0.3), corner()[:1])


def test_a_rounded_corner_touches_both_segments_at_the_same_distance_from_it():
    rounded = round_corners(corner(), lambda piece: True)
    room = 0.5  # half a segment, which is less than the longest blend
    assert room < LONGEST_BLEND
    assert rounded[1, :2] == pytest.approx([1.0 - room, 0.0])
    assert rounded[-2, :2] == pytest.approx([1.0, room])
    middle = rounded[len(rounded) // 2, :2]
    assert middle == pytest.approx([1.0 - room / 4, room / 4])  # of a parabola: half of the way to the chord
    assert np.array_equal(rounded[[0, -1]], corner()[[0, -1]])


def test_a_corner_that_cannot_be_rounded_stays():
    assert np.array_equal(round_corners(corner(), lambda piece: False), corner())


def test_a_corner_is_rounded_as_far_as_there_is_room():
    """Further than 0.15 rad before the corner nothing is free: blends of 0.5 and 0.25 rad are refused, 0.125 is not."""
    rounded = round_corners(corner(), lambda piece: bool((piece[:, 0] >= 0.85).all()))
    assert rounded[1, 0] == pytest.approx(0.875)


def test_a_straight_path_has_no_corner():
    straight = corner()[:2]
    assert round_corners(straight, lambda piece: False) is straight
