import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from smash.motion.paths import Path, round_corners
from smash.motion.timing import EASED, Pace, eased, time_path, trapezoid
from tests.robots import PANDA, READY

CORNERS = np.stack([READY, READY + 0.4, READY + np.array([0.8, 0.2, 0, 0.1, 0, 0.3, -0.4])])


@pytest.mark.parametrize("path", [Path(CORNERS[:2], "straight"), Path(CORNERS, "tree")])
@pytest.mark.parametrize("pace", [Pace(), Pace(0.25, 0.1)])
def test_a_trajectory_starts_and_ends_at_rest_and_keeps_the_limits(path, pace):
    trajectory = time_path(PANDA, path, pace)
    step = 1e-3
    samples = np.vstack([path.start, trajectory.sample(step)])
    velocity = np.diff(samples[:-1], axis=0) / step
    acceleration = np.diff(velocity, axis=0) / step
    assert np.allclose(samples[-1], path.end)
    assert np.allclose(trajectory.velocities[[0, -1]], 0.0)
    assert np.all(np.abs(velocity) <= pace.velocity * PANDA.velocity * 1.02)
    assert np.quantile(np.abs(acceleration) / (pace.acceleration * PANDA.acceleration), 0.98) <= 1.1


@pytest.mark.parametrize("path", [Path(CORNERS[:2], "straight"), Path(CORNERS, "tree")])
@pytest.mark.parametrize("pace", [Pace(), Pace(0.25, 0.1), Pace(1.0, 1.0), Pace(1.0, 0.5, tool_speed=0.3)])
def test_a_trajectory_keeps_the_panda_s_limits_at_the_rate_of_its_controller_jerk_included(path, pace):
    """Commands go to a Panda every millisecond; at rest before and afterwards."""
    step = 1e-3
    rest = np.repeat(path.start[None], 5, axis=0), np.repeat(path.end[None], 5, axis=0)
    samples = np.vstack([rest[0], time_path(PANDA, path, pace).sample(step), rest[1]])
    velocity = np.diff(samples, axis=0) / step
    acceleration = np.diff(velocity, axis=0) / step
    jerk = np.diff(acceleration, axis=0) / step
    assert np.all(np.abs(velocity) <= PANDA.velocity * 1.01)
    assert np.all(np.abs(acceleration) <= PANDA.acceleration * 1.02)
    assert np.all(np.abs(jerk) <= PANDA.jerk)


def test_an_eased_trajectory_takes_a_moment_longer_and_hardly_leaves_the_path():
    steep = trapezoid(PANDA, READY, READY + np.array([1.0, 0.3, 0, 0, 0, 0, 0]), Pace(1.0, 1.0))
    soft = eased(steep)
    assert soft.duration == pytest.approx(steep.duration + EASED)
    direction = np.array([1.0, 0.3, 0, 0, 0, 0, 0]) / np.hypot(1.0, 0.3)
    off = soft.positions - READY
    assert np.abs(off - (off @ direction)[:, None] * direction).max() < 1e-9
    assert np.abs(soft.at(soft.times) - steep.at(soft.times - EASED / 2)).max() <= 15.0 * EASED**2 / 24 + 1e-4


def test_a_straight_segment_runs_at_the_limit_of_its_slowest_joint():
    trajectory = trapezoid(PANDA, READY, READY + np.array([2.0, 0, 0, 0, 0, 0, 0]), Pace(1.0, 1.0))
    assert trajectory.duration == pytest.approx(2.0 / PANDA.velocity[0] + PANDA.velocity[0] / PANDA.acceleration[0])
    assert np.abs(trajectory.velocities).max() == pytest.approx(PANDA.velocity[0])


def test_a_path_of_no_length_takes_no_time():
    trajectory = time_path(PANDA, Path(np.stack([READY, READY]), "straight"))
    assert trajectory.duration == 0.0
    assert np.array_equal(trajectory.sample(0.01), READY[None])


def test_a_trajectory_stays_on_its_path():
    path = Path(round_corners(CORNERS, lambda _: True), "tree")
    samples = time_path(PANDA, path).sample(0.005)
    begin, end = path.waypoints[:-1, None], path.waypoints[1:, None]
    part = np.sum((samples - begin) * (end - begin), axis=2) / np.sum((end - begin) ** 2, axis=2)
    nearest = begin + np.clip(part, 0, 1)[:, :, None] * (end - begin)
    assert np.abs(samples - nearest).max(axis=2).min(axis=0).max() < 0.003


def test_a_finer_sampling_of_a_trajectory_passes_through_the_coarser_one():
    trajectory = time_path(PANDA, Path(CORNERS, "tree"))
    assert np.allclose(trajectory.sample(0.01)[:-1], trajectory.sample(0.002)[4::5][: len(trajectory.sample(0.01)) - 1])


def test_a_trajectory_backwards_keeps_the_limits_and_passes_the_same_places():
    forth = time_path(PANDA, Path(CORNERS, "tree"), Pace(1.0, 1.0))
    back, step = forth.reversed(), 1e-3
    assert back.duration == forth.duration
    moments = np.linspace(0.0, forth.duration, 50)
    assert np.allclose(back.at(moments), forth.at(forth.duration - moments))
    rest = np.repeat(CORNERS[-1:], 5, axis=0), np.repeat(CORNERS[:1], 5, axis=0)
    samples = np.vstack([rest[0], back.sample(step), rest[1]])
    for order, limit in ((1, PANDA.velocity * 1.01), (2, PANDA.acceleration * 1.02), (3, PANDA.jerk)):
        assert np.all(np.abs(np.diff(samples, order, axis=0)) / step**order <= limit)


def test_between_its_knots_a_trajectory_is_their_cubic():
    trajectory = time_path(PANDA, Path(CORNERS, "tree"))
    moments = np.linspace(0.0, trajectory.duration, 77)
    cubic = CubicHermiteSpline(trajectory.times, trajectory.positions, trajectory.velocities)
    assert np.abs(trajectory.at(moments) - cubic(moments)).max() < 1e-12
