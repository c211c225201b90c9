"""When the arm is where: paths become trajectories within a robot's velocity and acceleration limits.

A straight joint segment gets the fastest synchronised trapezoid; any other path goes through toppra (time-optimal path
parameterisation by reachability analysis) on a spline through closely spaced points, since a spline through sparse ones
leaves the path.

Both switch the acceleration at once, which no arm does. So every trajectory is averaged over a moment: what is bounded
stays bounded, and the acceleration passes from one value to the next in that moment (`eased`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from smash.motion.errors import NoMotion
from smash.motion.kernel import Array, IntArray, compiled
from smash.motion.parameterization import parameterized
from smash.motion.paths import Path, Waypoints, densify
from smash.motion.robot import Robot

KNOT_STEP = 0.01
"""Trajectories are stored at this interval [s]."""
SPLINE_STEP = 0.05
"""Largest joint distance between the spline's points [rad]."""
EASED = 0.03
"""The moment in which the acceleration passes from one value to another [s]: so much longer a motion takes."""
HARDEST = 3.2
"""The jerk of an eased motion is this many accelerations over `EASED` at most: 2, and what the knots add to it."""
EASED_STEP = 0.001
"""The averages over it are sums at this interval [s]."""
MOST_ON_CURVES = 0.9
"""Share of the acceleration limits that toppra is given at most: between its grid points it goes a tenth beyond."""
FEWEST_GRIDPOINTS, MOST_GRIDPOINTS = 40, 150


@dataclass(frozen=True)
class Pace:
    """How much of the arm's limits a motion may use.

    Attributes:
        velocity: Fraction of the joint velocity limits, in (0, 1].
        acceleration: Fraction of the joint acceleration limits, in (0, 1].
        tool_speed: Greatest speed of the tool frame's origin [m/s], or None.
    """

    velocity: float = 1.0
    acceleration: float = 0.5
    tool_speed: float | None = None


FREE = Pace()
"""Motions through the free space."""


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Configurations over time; cubic Hermite between the knots.

    Attributes:
        times: Knots [s], shape (T,), from 0.
        positions: [rad], shape (T, n).
        velocities: [rad/s], shape (T, n).
    """

    times: NDArray[np.float64]
    positions: NDArray[np.float64]
    velocities: NDArray[np.float64]

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self.times[-1])

    def at(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Configurations at `times` [s], shape (N,), held at the ends: [rad], shape (N, n)."""
        if len(self.times) < 2:
            return np.repeat(self.positions, len(times), axis=0)
        clipped = np.clip(times, 0.0, self.duration)
        index = np.clip(np.searchsorted(self.times, clipped, side="right") - 1, 0, len(self.times) - 2)
        span = self.times[index + 1] - self.times[index]
        part = (clipped - self.times[index]) / span
        square, cube = part**2, part**3
        return hermite(self.positions, self.velocities, index, span, part, square, cube)

    def reversed(self) -> Trajectory:
        """The same motion backwards: it keeps what this one keeps, and is as fast."""
        return Trajectory(
            self.duration - self.times[::-1],
            np.ascontiguousarray(self.positions[::-1]),
            np.ascontiguousarray(-self.velocities[::-1]),
        )

    def sample(self, step: float) -> NDArray[np.float64]:
        """Configurations every `step` [s] after the start, the end included: [rad], shape (N, n)."""
        count = max(1, int(np.ceil(self.duration / step - 1e-9)))
        return self.at(np.minimum(np.arange(1, count + 1) * step, self.duration))


@compiled
def hermite(
    positions: Array, velocities: Array, index: IntArray, span: Array, part: Array, square: Array, cube: Array
) -> Array:
    """Cubic Hermite interpolation between knots [rad], shape (N, n).

    Args:
        positions: At the knots [rad], shape (T, n).
        velocities: At the knots [rad/s], shape (T, n).
        index: The knot before each moment, shape (N,).
        span: From that knot to the next one [s], shape (N,).
        part: The share of it that has passed, shape (N,).
        square: Its square.
        cube: Its cube.
    """
    between = np.empty((index.shape[0], positions.shape[1]))
    for row in range(index.shape[0]):
        here = index[row]
        start, leave = 2 * cube[row] - 3 * square[row] + 1, (cube[row] - 2 * square[row] + part[row]) * span[row]
        end, arrive = 3 * square[row] - 2 * cube[row], (cube[row] - square[row]) * span[row]
        for joint in range(positions.shape[1]):
            between[row, joint] = (
                start * positions[here, joint]
                + leave * velocities[here, joint]
                + end * positions[here + 1, joint]
                + arrive * velocities[here + 1, joint]
            )
    return between


def time_path(robot: Robot, path: Path, pace: Pace = FREE) -> Trajectory:
    """The fastest trajectory along the path that begins and ends at rest and keeps the pace, `eased`.

    Args:
        robot: Whose limits are kept.
        path: Where.
        pace: Share of the limits, and the tool's greatest speed.

    Raises:
        NoMotion: No trajectory along the path keeps the limits.
    """
    if path.length < 1e-9:
        return Trajectory(np.zeros(1), path.waypoints[:1], np.zeros((1, path.waypoints.shape[1])))
    if len(path.waypoints) == 2 and pace.tool_speed is None:
        return eased(trapezoid(robot, path.start, path.end, pace))
    return eased(_toppra(robot, path.waypoints, pace))


def eased(trajectory: Trajectory) -> Trajectory:
    """The average of a trajectory over the last `EASED` seconds, at rest at both ends as it is.

    Velocity and acceleration are averages too, so they keep every limit that they kept before, and the jerk is at most
    the greatest change of acceleration over `EASED`: within the robot's limits (`_rise`). With an acceleration of at
    most a [rad/s^2] the path is left by a EASED^2 / 24, a fraction of a milliradian.
    """
    duration = trajectory.duration + EASED
    knots = np.arange(0.0, duration - KNOT_STEP / 2, KNOT_STEP)
    window, stride = round(EASED / EASED_STEP), round(KNOT_STEP / EASED_STEP)
    weights = np.full(window + 1, 1.0 / window)
    weights[[0, -1]] /= 2
    # What is averaged for one knot overlaps with that for the next: it is looked at once.
    moments = np.arange(-window, stride * (len(knots) - 1) + 1, dtype=np.float64) * EASED_STEP
    past = sliding_window_view(trajectory.at(moments), window + 1, axis=0)[::stride]
    ends = trajectory.positions[[0, -1]]
    positions = np.concatenate([past @ weights, ends[1:]])
    velocities = np.concatenate([(past[:, :, -1] - past[:, :, 0]) / EASED, np.zeros_like(ends[1:])])
    positions[0], velocities[0] = ends[0], 0.0
    return Trajectory(np.append(knots, duration), positions, velocities)


def trapezoid(robot: Robot, begin: NDArray[np.float64], end: NDArray[np.float64], pace: Pace = FREE) -> Trajectory:
    """All joints start and stop together on the straight segment: the time-optimal motion along it.

    With s in [0, 1] along the segment, the speed limit is min_j v_j / |d_j| and the acceleration limit
    min_j a_j / |d_j| for the displacement d [rad].
    """
    displacement = end - begin
    size = np.maximum(np.abs(displacement), 1e-12)
    acceleration = float(np.min(_rise(robot, pace.acceleration) / size))
    speed = min(float(np.min(pace.velocity * robot.velocity / size)), float(np.sqrt(acceleration)))
    ramp = speed / acceleration
    duration = 1.0 / speed + ramp
    times = np.unique(np.concatenate([np.arange(0.0, duration, KNOT_STEP), [ramp, duration - ramp, duration]]))
    rising = np.minimum(times, ramp)
    falling = np.maximum(times - (duration - ramp), 0.0)
    cruising = np.clip(times - ramp, 0.0, duration - 2 * ramp)
    part = 0.5 * acceleration * rising**2 + speed * cruising + speed * falling - 0.5 * acceleration * falling**2
    rate = acceleration * (rising - falling)
    part[-1], rate[-1] = 1.0, 0.0
    return Trajectory(times, begin + part[:, None] * displacement, rate[:, None] * displacement)


def time_gently(robot: Robot, path: Path, length: float, speed: float, acceleration: float) -> Trajectory:
    """An eased trapezoid for a path whose waypoints are evenly spaced in the world: what is carried is hardly shaken.

    Args:
        robot: Whose limits are kept.
        path: Where; between two neighbouring waypoints a point of what is carried moves the same way.
        length: Of that point's way [m].
        speed: Its greatest speed [m/s].
        acceleration: Its greatest acceleration along the way [m/s2].
    """
    from scipy.interpolate import CubicSpline

    waypoints = path.waypoints
    tangent = np.gradient(waypoints, 1.0 / (len(waypoints) - 1), axis=0)
    steepest = np.maximum(np.abs(tangent).max(axis=0), 1e-12)
    fastest = min(speed / length, float(np.min(robot.velocity / steepest)))
    rise = acceleration / length
    rate = min(fastest, float(np.sqrt(rise)))
    ramp, duration = rate / rise, 1.0 / rate + rate / rise
    times = np.append(np.arange(0.0, duration, KNOT_STEP), duration)
    rising, falling = np.minimum(times, ramp), np.maximum(times - (duration - ramp), 0.0)
    part = rate * (np.clip(times - ramp, 0.0, duration - 2 * ramp) + falling) + 0.5 * rise * (rising**2 - falling**2)
    part = np.clip(part, 0.0, 1.0)
    part[-1] = 1.0
    at = np.linspace(0.0, 1.0, len(waypoints))
    spline = CubicSpline(at, waypoints)
    positions, velocities = spline(part), spline(part, 1) * (rise * (rising - falling))[:, None]
    positions[-1], velocities[-1] = waypoints[-1], 0.0
    return eased(Trajectory(times, positions, velocities))


def _toppra(robot: Robot, waypoints: Waypoints, pace: Pace) -> Trajectory:
    # toppra loads a plotting library: a second that `smash plan` must not pay.
    import toppra
    from toppra.constraint import JointVelocityConstraintVarying

    points = densify(waypoints, SPLINE_STEP)
    points = points[np.concatenate([[True], np.any(np.abs(np.diff(points, axis=0)) > 1e-9, axis=1)])]
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    spline = toppra.SplineInterpolator(arc, points)
    constraints = list(_joint_limits(robot, pace.velocity, min(pace.acceleration, MOST_ON_CURVES)))
    if pace.tool_speed is not None:
        tool_speed = pace.tool_speed
        constraints.append(
            JointVelocityConstraintVarying(lambda s: _tool_limits(robot, spline(s), spline(s, 1), tool_speed))
        )
    grid = np.linspace(0.0, arc[-1], int(np.clip(2 * len(points), FEWEST_GRIDPOINTS, MOST_GRIDPOINTS)))
    fastest = parameterized(spline, grid, constraints)
    if fastest is None:
        raise NoMotion("the path cannot be followed within the arm's velocity and acceleration limits")
    times = np.append(np.arange(0.0, fastest.duration, KNOT_STEP), fastest.duration)
    positions, velocities = fastest.at(times)
    positions[-1], velocities[-1] = waypoints[-1], 0.0
    return Trajectory(times, positions, velocities)


def _rise(robot: Robot, share: float) -> NDArray[np.float64]:
    """Acceleration limits at a pace, no greater than what the jerk limits let through (`eased`) [rad/s^2], (n,)."""
    return np.asarray(np.minimum(share * robot.acceleration, robot.jerk * EASED / HARDEST))


@cache
def _joint_limits(robot: Robot, velocity: float, acceleration: float) -> tuple[Any, Any]:
    """The constraints of toppra for shares of the joints' limits: they write themselves out as texts when made."""
    from toppra.constraint import JointAccelerationConstraint, JointVelocityConstraint

    speed, rise = velocity * robot.velocity, _rise(robot, acceleration)
    return (
        JointVelocityConstraint(np.column_stack([-speed, speed])),
        JointAccelerationConstraint(np.column_stack([-rise, rise])),
    )


def _tool_limits(
    robot: Robot, joints: NDArray[np.float64], tangent: NDArray[np.float64], speed: float
) -> NDArray[np.float64]:
    """Joint velocity limits, shape (n, 2) [rad/s], that keep the tool's speed along the path's tangent."""
    tool = float(np.linalg.norm(robot.jacobian(joints)[:3] @ tangent))
    limit = np.abs(tangent) * speed / max(tool, 1e-6) + 1e-6
    return np.column_stack([-limit, limit])
