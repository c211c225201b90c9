"""What an episode leaves beside its record."""

import numpy as np
import pytest

from smash.execution.viewing.capture import Capture
from smash.execution.viewing.trajectory_file import TRAJECTORY_INTERVAL, thinned
from smash.problem import MalformedFile
from tests.execution.made_up import recording_of


def test_frames_are_taken_only_where_a_picture_is_asked_for(tmp_path):
    assert Capture(trajectory=tmp_path / "t.csv").frame is None
    assert Capture(stills=tmp_path / "s.png").frame is not None
    assert Capture(stills=tmp_path / "s.png", trajectory=tmp_path / "t.csv").files == [
        tmp_path / "s.png",
        tmp_path / "t.csv",
    ]


@pytest.mark.parametrize(
    ("what", "name"), [("video", "film.avi"), ("stills", "stills.txt"), ("trajectory", "t.txt"), ("trajectory", "t")]
)
def test_a_file_that_cannot_be_written_is_refused_before_the_episode(tmp_path, what, name):
    with pytest.raises(MalformedFile, match=name) as refusal:
        Capture(**{what: tmp_path / name})
    assert "\n" not in str(refusal.value)


def test_a_trajectory_has_a_row_each_interval_of_simulated_time():
    samples = [(step / 480, np.zeros(7), 0.0) for step in range(481)]
    times = [moment for moment, *_ in thinned(samples)]
    assert times[0] == 0.0
    assert min(np.diff(times)) >= TRAJECTORY_INTERVAL - 1e-6
    assert max(np.diff(times)) < TRAJECTORY_INTERVAL + 1 / 480


@pytest.mark.parametrize(("moment", "frame"), [(0.0, 0), (0.079, 0), (0.08, 1), (0.2, 2), (99.0, 12)])
def test_the_frame_of_a_moment_is_the_last_one_before_it(moment, frame):
    """Frames lie 0.08 s apart, the first at 0."""
    assert recording_of(1, seconds=0.96).at(moment) == frame


@pytest.mark.parametrize(("begin", "end", "moment"), [(0.0, 0.96, 0.4), (0.5, 0.96, 0.72), (0.3, 0.3, 0.3)])
def test_the_liveliest_moment_is_that_at_which_blocks_move_most(begin, end, moment):
    recording = recording_of(2, seconds=0.96)
    for frame, shift in ((5, 0.1), (9, 0.05)):  # 0.4 s and 0.72 s
        recording.blocks[frame:] = [poses + np.eye(7)[0] * shift for poses in recording.blocks[frame:]]
    assert recording.liveliest(begin, end) == pytest.approx(moment)
