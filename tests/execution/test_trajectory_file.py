import numpy as np
import pytest

from smash.execution.viewing.trajectory_file import read_trajectory, write_trajectory
from smash.motion.timing import trapezoid
from smash.problem.errors import MalformedFile
from tests.robots import PANDA, READY


def test_a_trajectory_is_read_back_bit_for_bit(tmp_path):
    trajectory = trapezoid(PANDA, READY, READY + 0.3)
    wide = np.linspace(0.0, 0.04, len(trajectory.times))
    write_trajectory(tmp_path / "t.csv", PANDA.joints, zip(trajectory.times, trajectory.positions, wide, strict=True))
    times, joints, openings = read_trajectory(tmp_path / "t.csv")
    assert np.array_equal(openings, wide)
    assert np.array_equal(times, trajectory.times)
    assert np.array_equal(joints, trajectory.positions)


def test_an_episode_without_a_motion_is_a_header_alone(tmp_path):
    write_trajectory(tmp_path / "t.csv", PANDA.joints, [])
    times, joints, openings = read_trajectory(tmp_path / "t.csv")
    assert times.shape == openings.shape == (0,)
    assert joints.shape == (0, 7)


@pytest.mark.parametrize("content", ["", "time,a\n", "HEADER\n1\n", "HEADER\n1,2\n", "HEADER\n1,2,3,4,5,6,7,8,x\n"])
def test_another_file_is_refused_in_one_line(tmp_path, content):
    header = "time," + ",".join(f"panda_joint{number}" for number in range(1, 8)) + ",finger_opening"
    (tmp_path / "t.csv").write_text(content.replace("HEADER", header))
    with pytest.raises(MalformedFile, match=r"t\.csv: "):
        read_trajectory(tmp_path / "t.csv")
