"""An episode as ROS 2 messages, read back with the library's own reader."""

import json
import sys
from itertools import pairwise

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from smash.execution.executor import Executor
from smash.execution.policy import OPEN
from smash.execution.readback import read_state
from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.scene_file import default_scene
from smash.execution.viewing.capture import Capture
from smash.execution.viewing.ros_bag import ACTION, JOINTS, POSES, SHAPES, arm_topic, hand_topic, write_bag
from smash.execution.viewing.ros_messages import definition
from smash.motion.poses import Matrix
from smash.problem.extras import MissingExtra
from tests.execution.episodes import buried_plan, buried_target
from tests.execution.made_up import episode_of, recording_of
from tests.robots import PANDA, READY

ARM, HAND = arm_topic(PANDA), hand_topic(PANDA)


def messages_of(path):
    """Topic -> (moment [s], message) of a file; every message is decoded."""
    found = {}
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()], validate_crcs=True)
        for _, channel, message, content in reader.iter_decoded_messages():
            found.setdefault(channel.topic, []).append((message.log_time * 1e-9, content))
        assert reader.get_header().profile == "ros2"
        statistics = reader.get_summary().statistics
    assert statistics.message_count == sum(map(len, found.values()))
    assert statistics.channel_count == len(found)
    return found


def rotation(q) -> Matrix:
    x, y, z, w = q.x, q.y, q.z, q.w
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def poses_of(message):
    return {
        frame.child_frame_id: BlockPose(
            np.array([getattr(frame.transform.translation, axis) for axis in "xyz"]), rotation(frame.transform.rotation)
        )
        for frame in message.transforms
    }


def seconds_of(time):
    return time.sec + time.nanosec * 1e-9


@pytest.fixture(scope="module")
def performed(tmp_path_factory):
    """An episode with a topple, a gap task and its file."""
    path = tmp_path_factory.mktemp("bag") / "episode.mcap"
    capture = Capture(trajectory=path)
    executor = Executor(buried_target(), buried_plan(), default_scene(), policy=OPEN, on_frame=capture.frame)
    episode = executor.run()
    assert episode.success, episode.failure
    capture.finish(executor, episode)
    return executor, episode, path, messages_of(path)


def test_every_topic_is_there_and_its_times_go_forward(performed):
    executor, _, _, found = performed
    assert set(found) == {ARM, HAND, JOINTS, POSES, SHAPES, ACTION}
    for sent in found.values():
        times = [moment for moment, _ in sent]
        assert times == sorted(times)
        assert 0.0 <= times[0] <= times[-1] <= executor.world.time + 1e-6
    for topic in (JOINTS, POSES):
        assert all(later > earlier for (earlier, _), (later, _) in pairwise(found[topic]))


def test_joints_have_the_names_of_the_urdf_and_keep_its_limits(performed):
    for _, state in performed[3][JOINTS]:
        assert tuple(state.name) == (*PANDA.joints, *PANDA.hand.joints)
        assert PANDA.within_limits(np.array(state.position[:7]), 0.01)
    for topic, names in ((ARM, PANDA.joints), (HAND, PANDA.hand.joints)):
        for _, trajectory in performed[3][topic]:
            assert tuple(trajectory.joint_names) == names
            assert all(len(point.positions) == len(names) for point in trajectory.points)


def test_an_action_has_a_trajectory_that_begins_at_rest_where_the_last_one_ended(performed):
    executor, episode, _, found = performed
    assert [words.data for _, words in found[ACTION]] == [" ".join(map(str, row.action)) for row in episode.actions]
    begun = [row.begun for row in episode.actions]
    for topic in (ARM, HAND):
        trajectories = found[topic]
        assert [moment for moment, _ in trajectories] == pytest.approx(begun, abs=1e-8)
        for _, trajectory in trajectories:
            times = [seconds_of(point.time_from_start) for point in trajectory.points]
            assert times[0] == 0.0
            assert all(later > earlier for earlier, later in pairwise(times))
        for (_, before), (_, after) in pairwise(trajectories):
            assert np.array_equal(before.points[-1].positions, after.points[0].positions)
    assert np.allclose(found[ARM][0][1].points[0].positions, READY)
    assert np.array_equal(found[ARM][-1][1].points[-1].positions, executor.world.commanded())
    for _, trajectory in found[ARM]:
        speeds = np.array([point.velocities for point in trajectory.points])
        assert np.all(speeds[[0, -1]] == 0.0)
        assert np.all(np.abs(speeds) <= PANDA.velocity)


def test_the_points_of_the_arm_are_what_it_was_sent_to(performed):
    recorded = performed[0].world.recorded
    times = np.array([moment for moment, *_ in recorded])
    for begun, trajectory in performed[3][ARM]:
        for point in trajectory.points:
            row = np.abs(times - begun - seconds_of(point.time_from_start)).argmin()
            assert np.array_equal(point.positions, recorded[row][1])


def test_poses_of_all_blocks_end_as_the_episode_does(performed):
    executor, episode, _, found = performed
    blocks = list(executor.instance.blocks)
    for moment, message in found[POSES]:
        assert [frame.child_frame_id for frame in message.transforms] == blocks
        assert {frame.header.frame_id for frame in message.transforms} == {"panda_link0"}
        assert all(seconds_of(frame.header.stamp) == pytest.approx(moment) for frame in message.transforms)
    start, end = poses_of(found[POSES][0][1]), poses_of(found[POSES][-1][1])
    assert end["a"].distance(*executor.table.point("g")) < 0.01 < start["a"].distance(*executor.table.point("g"))
    for block, pose in executor.ended.blocks.items():
        assert np.array_equal(end[block].position, pose.position)
        assert np.allclose(end[block].rotation, pose.rotation, atol=1e-9)
    state = read_state(Geometry(executor.table.slots, {}, end, {}), executor.tabletop)
    assert {place: pile for place, pile in state.piles.items() if pile} == episode.final.piles
    assert sorted(state.table) == episode.final.table


def test_a_block_is_a_box_in_its_frame(performed):
    (moment, message), *more = performed[3][SHAPES]
    assert (moment, more) == (0.0, [])
    assert [marker.header.frame_id for marker in message.markers] == list(performed[0].instance.blocks)
    for marker in message.markers:
        assert (marker.type, marker.frame_locked, marker.pose.orientation.w) == (1, True, 1.0)
        assert marker.scale.x == performed[0].tabletop.side


def test_the_record_of_the_episode_is_attached(performed):
    with performed[2].open("rb") as stream:
        attached = {part.name: part for part in make_reader(stream).iter_attachments()}
    assert json.loads(attached["episode.json"].data)["success"] is True


def test_an_episode_without_actions_has_a_trajectory_that_stands_still(tmp_path):
    recorded = [(step / 480, READY, 0.04) for step in range(1, 49)]
    end = 0.1, Geometry({}, {}, {"ä b": BlockPose(np.zeros(3), np.eye(3))}, {})
    write_bag(tmp_path / "e.mcap", PANDA, recorded, recording_of(1, 0.08), end, default_scene(), episode_of("none"))
    found = messages_of(tmp_path / "e.mcap")
    ((_, trajectory),) = found[ARM]
    assert all(np.array_equal(point.positions, READY) for point in trajectory.points)
    assert found[POSES][-1][1].transforms[0].child_frame_id == "ä b"


def test_equal_episodes_make_equal_files_however_long_they_were_planned(tmp_path):
    recorded = [(step / 480, READY + 0.001 * step, 0.04 if step < 9 else 0.02) for step in range(1, 49)]
    end = 0.1, Geometry({}, {}, {"a": BlockPose(np.zeros(3), np.eye(3))}, {})
    files = tmp_path / "1.mcap", tmp_path / "2.mcap"
    for seconds, path in enumerate(files):
        episode = episode_of("one", ["pick", "a"])
        episode.times.offline = episode.actions[0].times.online = float(seconds)
        write_bag(path, PANDA, recorded, recording_of(1, 0.08), end, default_scene(), episode)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_a_definition_names_each_part_once():
    lines = definition("visualization_msgs/msg/MarkerArray").splitlines()
    parts = [line for line in lines if line.startswith("MSG: ")]
    assert len(parts) == len(set(parts)) > 8
    assert lines[0] == "visualization_msgs/Marker[] markers"


def test_without_the_extra_the_line_says_how_to_get_it(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "mcap_ros2", None)
    with pytest.raises(MissingExtra, match=r"pip install 'smash-testbed\[ros\]'") as refusal:
        Capture(trajectory=tmp_path / "t.mcap")
    assert refusal.value.exit_code == 6
    assert "\n" not in str(refusal.value)
