"""An episode as ROS 2 messages in one MCAP file: `smash execute --trajectory FILE.mcap`.

Foxglove and rosbag2 read it as it is. Time begins at 0 with the episode, in simulated seconds; equal episodes make
equal files. The topics:

- `/ROBOT_arm_controller/joint_trajectory` (the robot's name, `_` for `-`): what the arm was sent to, a message an
  action, at the moment at which it began. Each starts where the one before ended, at rest, and has the stamp 0, which a
  controller takes for "now".
- `/HAND_controller/joint_trajectory` (the hand's name, likewise): where the fingers were sent to meanwhile.
- `/joint_states`: arm and fingers as measured.
- `/tf`: blocks and carriers as they were, as frames of their names in the robot's base; the last message is the
  episode's end.
- `/blocks`: a box for each block and carrier, once, fixed to its frame.
- `/action`: the action that begins, in words.

The episode's record is attached as `episode.json`, without the measured times, which differ from run to run.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from smash.execution.scene.block_pose import quaternion_of
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.tabletop import Tabletop
from smash.execution.viewing.recording import Recording
from smash.execution.viewing.ros_messages import (
    CUBE,
    JOINT_STATE,
    JOINT_TRAJECTORY,
    MARKERS,
    STRING,
    TRANSFORMS,
    definition,
)
from smash.execution.viewing.stage import TRAY_COLOUR, block_colours
from smash.execution.viewing.trajectory_file import Sample, thinned
from smash.motion.robot import Robot
from smash.problem.files.documents import one_key_a_line
from smash.records.episodes import Episode

JOINTS = "/joint_states"
POSES = "/tf"
SHAPES = "/blocks"
ACTION = "/action"


def arm_topic(robot: Robot) -> str:
    """Where an arm listens."""
    return f"/{_in_ros(robot.name)}_arm_controller/joint_trajectory"


def hand_topic(robot: Robot) -> str:
    """Where its hand does."""
    return f"/{_in_ros(robot.hand.name)}_controller/joint_trajectory"


def _in_ros(name: str) -> str:
    """A robot's or a hand's name as a part of a topic, in which ROS 2 allows no hyphen."""
    return name.replace("-", "_")


class _Sent(NamedTuple):
    """A message with the moment at which it is sent [s]."""

    moment: float
    topic: str
    kind: str
    content: Mapping[str, Any]


def write_bag(
    path: str | os.PathLike[str],
    robot: Robot,
    recorded: Sequence[Sample],
    recording: Recording,
    end: tuple[float, Geometry],
    tabletop: Tabletop,
    episode: Episode,
) -> None:
    """Write an episode as ROS 2 messages.

    Args:
        path: The file; it is overwritten.
        robot: Whose joints are sent.
        recorded: What arm and fingers were sent to, at every step of the simulation.
        recording: What was measured.
        end: The moment of the episode's end [s], and where things were then.
        tabletop: The scene.
        episode: How it went.
    """
    from mcap_ros2.writer import Writer

    messages = [
        *_actions(episode),
        *_trajectories(robot, recorded, [row.begun for row in episode.actions]),
        *_joint_states(robot, recording),
        *_poses(robot.base, recording, *end),
        _shapes(end[1], tabletop),
    ]
    with Path(path).open("wb") as stream, Writer(stream) as writer:
        kinds = {kind: writer.register_msgdef(kind, definition(kind)) for kind in {m.kind: None for m in messages}}
        for sent in sorted(messages, key=lambda message: message.moment):
            writer.write_message(sent.topic, kinds[sent.kind], sent.content, log_time=_nanoseconds(sent.moment))
        record = one_key_a_line(episode.without_measured_times())
        writer.add_attachment(0, 0, "episode.json", "application/json", record.encode())


def _actions(episode: Episode) -> Iterator[_Sent]:
    for row in episode.actions:
        yield _Sent(row.begun, ACTION, STRING, {"data": " ".join(map(str, row.action))})


def _trajectories(robot: Robot, recorded: Sequence[Sample], begun: Sequence[float]) -> Iterator[_Sent]:
    """Cut what was sent where actions begin; what comes before the first is a part of nothing, and stands still."""
    times = np.array([time for time, *_ in recorded])
    first = [min(int(np.searchsorted(times, moment - 1e-9)), len(times) - 1) for moment in begun] or [0]
    for since, until in pairwise([*first, len(recorded) - 1]):
        span = recorded[since : until + 1]
        yield _Sent(span[0][0], arm_topic(robot), JOINT_TRAJECTORY, _arm(robot, span))
        yield _Sent(span[0][0], hand_topic(robot), JOINT_TRAJECTORY, _fingers(robot, span))


def _arm(robot: Robot, span: Sequence[Sample]) -> dict[str, Any]:
    """The arm between two rests, thinned; its speed [rad/s] is that of the full rows."""
    times, joints = np.array([sample[0] for sample in span]), np.array([sample[1] for sample in span])
    speeds = np.gradient(joints, times, axis=0) if len(span) > 1 else np.zeros_like(joints)
    speeds[[0, -1]] = 0.0
    chosen = [row for _, row in thinned((sample[0], row) for row, sample in enumerate(span))]
    return _trajectory(robot.base, robot.joints, times, joints, sorted({*chosen, len(span) - 1}), speeds)


def _fingers(robot: Robot, span: Sequence[Sample]) -> dict[str, Any]:
    """The fingers' steps: the moments before and after each, and both ends."""
    times, openings = np.array([sample[0] for sample in span]), np.array([sample[2] for sample in span])
    after = np.flatnonzero(np.diff(openings)) + 1
    chosen = sorted({0, len(span) - 1, *(after - 1).tolist(), *after.tolist()})
    both = np.stack([openings, openings], axis=1)
    return _trajectory(robot.base, robot.hand.joints, times, both, chosen)


def _trajectory(
    base: str,
    names: Sequence[str],
    times: NDArray[np.float64],
    positions: NDArray[np.float64],
    chosen: Iterable[int],
    speeds: NDArray[np.float64] | None = None,
) -> dict[str, Any]:
    points = [
        {
            "positions": positions[row].tolist(),
            "velocities": [] if speeds is None else speeds[row].tolist(),
            "time_from_start": _time(float(times[row] - times[0])),
        }
        for row in chosen
    ]
    return {"header": _header(0.0, base), "joint_names": list(names), "points": points}


def _joint_states(robot: Robot, recording: Recording) -> Iterator[_Sent]:
    names = [*robot.joints, *robot.hand.joints]
    for moment, joints in zip(recording.times, recording.joints, strict=True):
        content = {"header": _header(moment, robot.base), "name": names, "position": joints.tolist()}
        yield _Sent(moment, JOINTS, JOINT_STATE, content)


def _poses(base: str, recording: Recording, ended: float, where: Geometry) -> Iterator[_Sent]:
    names = [*where.blocks, *where.carriers]
    for moment, blocks, trays in zip(recording.times, recording.blocks, recording.trays, strict=True):
        if moment < ended:
            yield _frames(base, moment, names, [*blocks, *trays])
    poses = [*where.blocks.values(), *where.carriers.values()]
    yield _frames(base, ended, names, [[*pose.position, *quaternion_of(pose.rotation)] for pose in poses])


def _frames(
    base: str, moment: float, names: Sequence[str], rows: Sequence[Sequence[float] | NDArray[np.float64]]
) -> _Sent:
    frames = []
    for name, row in zip(names, rows, strict=True):
        x, y, z, *turn = map(float, row)
        transform = {
            "translation": {"x": x, "y": y, "z": z},
            "rotation": dict(zip("xyzw", turn, strict=True)),
        }
        frames.append({"header": _header(moment, base), "child_frame_id": name, "transform": transform})
    return _Sent(moment, POSES, TRANSFORMS, {"transforms": frames})


def _shapes(where: Geometry, tabletop: Tabletop) -> _Sent:
    shapes = [
        (block, tabletop.size(block).edges, colour)
        for block, colour in zip(where.blocks, block_colours(len(where.blocks)), strict=True)
    ]
    for carrier in where.carriers:
        assert tabletop.tray is not None
        shapes.append((carrier, (*tabletop.tray.size, tabletop.tray.board), TRAY_COLOUR))
    markers = [
        {
            "header": _header(0.0, name),
            "ns": "blocks",
            "id": number,
            "type": CUBE,
            "pose": {"orientation": {"w": 1.0}},
            "scale": dict(zip("xyz", size, strict=True)),
            "color": dict(zip("rgba", (*colour, 1.0), strict=True)),
            "frame_locked": True,
            "text": name,
        }
        for number, (name, size, colour) in enumerate(shapes)
    ]
    return _Sent(0.0, SHAPES, MARKERS, {"markers": markers})


def _header(moment: float, frame: str) -> dict[str, Any]:
    return {"stamp": _time(moment), "frame_id": frame}


def _time(seconds: float) -> dict[str, int]:
    whole, rest = divmod(_nanoseconds(seconds), 10**9)
    return {"sec": whole, "nanosec": rest}


def _nanoseconds(seconds: float) -> int:
    return round(seconds * 1e9)
