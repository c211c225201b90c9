"""The files that `smash execute` can leave beside the episode: replay, film, stills, trajectory, looks."""

from __future__ import annotations

from pathlib import Path

from smash.execution.executor import Executor
from smash.execution.physics.world import Frame
from smash.execution.recorded_poses import Look, write_looks
from smash.execution.scene.tabletop import Tabletop
from smash.execution.viewing.film import FILM, Film, write_film
from smash.execution.viewing.painters import require_painter
from smash.execution.viewing.recording import Recording
from smash.execution.viewing.ros_bag import write_bag
from smash.execution.viewing.trajectory_file import thinned, write_trajectory
from smash.problem.errors import MalformedFile
from smash.problem.extras import require
from smash.problem.files.documents import replacing
from smash.records.episodes import Episode

FILMS = (".mp4", ".gif")
PICTURES = (".png", ".pdf", ".svg", ".jpg")
ROS = ".mcap"
TRAJECTORIES = (".csv", ROS)
"""How the names of what is written end."""


class Capture:
    """Records an episode where a file was asked for, and writes the files afterwards.

    Attributes:
        seen: Gets what the executor sees, where that is asked for.

    Raises:
        MalformedFile: at once, where the name of a film, of stills or of a trajectory ends in what cannot be written.
        Unsupported: at once, where nothing can draw them here, or what writes a trajectory is not installed.
    """

    def __init__(
        self,
        *,
        replay: Path | None = None,
        video: Path | None = None,
        stills: Path | None = None,
        trajectory: Path | None = None,
        looks: Path | None = None,
        film: Film = FILM,
    ) -> None:
        self.film = film
        self.replay, self.video, self.stills, self.trajectory = replay, video, stills, trajectory
        self.looks = looks
        self.seen: list[Look] | None = None if looks is None else []
        _require_suffix(video, "a film", FILMS)
        _require_suffix(stills, "stills", PICTURES)
        _require_suffix(trajectory, "a trajectory", TRAJECTORIES)
        self._for_ros = trajectory is not None and trajectory.suffix == ROS
        if self._for_ros:
            require(f"--trajectory {trajectory}", "mcap_ros2")
        if video or stills:
            require_painter()
        self.recording = Recording()

    @property
    def files(self) -> list[Path]:
        """What is asked for."""
        asked = (self.replay, self.video, self.stills, self.trajectory, self.looks)
        return [path for path in asked if path is not None]

    @property
    def frame(self) -> Frame | None:
        """What the executor calls at each frame; None where nothing needs frames."""
        return self.recording.take if self.replay or self.video or self.stills or self._for_ros else None

    def finish(self, executor: Executor, episode: Episode) -> None:
        """Write what was asked for, each file whole or not at all."""
        tabletop = executor.tabletop
        if self.trajectory is not None:
            with replacing(self.trajectory) as path:
                self._write_trajectory(path, executor, episode)
        if self.looks is not None:
            write_looks(self.looks, self.seen or ())
        if self.replay is not None:
            from smash.execution.viewing.replay import write_replay

            write_replay(self.replay, self.recording, tabletop, episode, executor.instance)
        if self.stills is not None:
            with replacing(self.stills) as path:
                self._write_stills(path, tabletop, episode)
        if self.video is not None:
            with replacing(self.video) as path:
                write_film(path, self.recording, tabletop, episode, self.film)

    def _write_trajectory(self, path: Path, executor: Executor, episode: Episode) -> None:
        recorded = executor.world.recorded
        if self._for_ros:
            end = executor.world.time, executor.ended
            write_bag(path, executor.arm.robot, recorded, self.recording, end, executor.tabletop, episode)
        else:
            write_trajectory(path, executor.arm.robot.joints, thinned(recorded))

    def _write_stills(self, path: Path, tabletop: Tabletop, episode: Episode) -> None:
        from smash.execution.viewing.pictures import write_stills

        times = self.recording.times
        captions = [("start", times[0]), ("on the way", times[len(times) // 2])]
        topple = next((row for row in episode.actions if row.action[0] == "topple"), None)
        if topple is not None:
            after = topple.begun + topple.times.execution
            falling = self.recording.liveliest(topple.begun, after)
            captions[1:] = [("the topple", falling), ("after the topple", after)]
        captions.append(("end" if episode.success else "end (failed)", times[-1]))
        write_stills(path, self.recording, tabletop, captions)


def _require_suffix(path: Path | None, what: str, allowed: tuple[str, ...]) -> None:
    if path is not None and path.suffix not in allowed:
        raise MalformedFile(str(path), f"the name of {what} ends in {', '.join(allowed[:-1])} or {allowed[-1]}")
