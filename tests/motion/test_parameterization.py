"""The passes of TOPP-RA: what they give is what toppra's own classes give, to the last bit."""

import numpy as np
import pytest
import toppra
from toppra.algorithm import TOPPRA
from toppra.constraint import JointAccelerationConstraint, JointVelocityConstraint, JointVelocityConstraintVarying

from smash.motion.parameterization import parameterized


def spline_through(seed, points=12):
    """A spline through points of a random walk of seven joints, and a grid along it."""
    generator = np.random.default_rng(seed)
    corners = np.cumsum(generator.normal(0.0, 0.2, (points, 7)), axis=0)
    ways = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    return toppra.SplineInterpolator(ways, corners), np.linspace(0.0, ways[-1], 4 * points)


def limits(speed, rise, *more):
    speeds, rises = np.full(7, speed), np.full(7, rise)
    return [
        JointVelocityConstraint(np.column_stack([-speeds, speeds])),
        JointAccelerationConstraint(np.column_stack([-rises, rises])),
        *more,
    ]


def slower_on_the_way(way):
    return np.column_stack([-np.full(7, 0.2 + way), np.full(7, 0.2 + way)])


@pytest.mark.parametrize("more", [[], [JointVelocityConstraintVarying(slower_on_the_way)]])
@pytest.mark.parametrize("seed", range(5))
def test_toppra_itself_gives_the_same_positions_and_velocities(seed, more):
    spline, grid = spline_through(seed)
    constraints = limits(1.0, 2.0 + seed, *more)
    theirs = TOPPRA(
        constraints, spline, gridpoints=grid, parametrizer="ParametrizeConstAccel", solver_wrapper="seidel"
    ).compute_trajectory(0.0, 0.0)
    ours = parameterized(spline, grid, constraints)
    assert ours.duration == theirs.duration
    times = np.append(np.arange(0.0, ours.duration, 0.01), ours.duration)
    positions, velocities = ours.at(times)
    assert np.array_equal(positions, theirs(times))
    assert np.array_equal(velocities, theirs(times, 1))


def test_where_the_arm_can_only_speed_up_there_is_none():
    spline, grid = spline_through(1)
    rises = np.full(7, 1.0)
    onward = JointAccelerationConstraint(np.column_stack([0.5 * rises, rises]))
    assert parameterized(spline, grid, [onward]) is None
