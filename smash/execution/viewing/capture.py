"""The files that `smash execute` can leave beside the episode: replay, film, stills, joint trajectory."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smash.execution.executor import Executor
from smash.execution.physics.world import Frame
from smash.execution.scene.tabletop import Tabletop
from smash.execution.viewing.film import FILM, Film, write_film
from smash.execution.viewing.painters import require_painter
from smash.execution.viewing.recording import Recording
from smash.execution.viewing.trajectory_file import write_trajectory
from smash.problem.errors import MalformedFile
from smash.problem.files.documents import replacing
from smash.records.episodes import Episode

FILMS = (".mp4", ".gif")
PICTURES = (".png", ".pdf", ".svg", ".jpg")
"""How the names of what is written end."""

Sample = tuple[float, NDArray[np.float64], float]

TRAJECTORY_INTERVAL = 0.01
"""Time between two rows of an exported trajectory [s]."""


class Capture:
    """Records an episode where a file was asked for, and writes the files afterwards.

    Raises:
        MalformedFile: at once, where the name of a film or of stills ends in what cannot be written.
        Unsupported: at once, where nothing can draw them here.
    """

    def __init__(
        self,
        *,
        replay: Path | None = None,
        video: Path | None = None,
        stills: Path | None = None,
        trajectory: Path | None = None,
        film: Film = FILM,
    ) -> None:
        self.film = film
        self.replay, self.video, self.stills, self.trajectory = replay, video, stills, trajectory
        _require_suffix(video, "a film", FILMS)
        _require_suffix(stills, "stills", PICTURES)
        if video or stills:
            require_painter()
        self.recording = Recording()

    @property
    def files(self) -> list[Path]:
        """What is asked for."""
        return [path for path in (self.replay, self.video, self.stills, self.trajectory) if path is not None]

    @property
    def frame(self) -> Frame | None:
        """What the executor calls at each frame; None where nothing needs frames."""
        return self.recording.take if self.replay or self.video or self.stills else None

    def finish(self, executor: Executor, episode: Episode) -> None:
        """Write what was asked for, each file whole or not at all."""
        tabletop = executor.tabletop
        if self.trajectory is not None:
            with replacing(self.trajectory) as path:
                write_trajectory(path, _thinned(executor.world.recorded))
        if self.replay is not None:
            from smash.execution.viewing.replay import write_replay

            write_replay(self.replay, self.recording, tabletop, episode, executor.instance)
        if self.stills is not None:
            with replacing(self.stills) as path:
                self._write_stills(path, tabletop, episode)
        if self.video is not None:
            with replacing(self.video) as path:
                write_film(path, self.recording, tabletop, episode, self.film)

    def _write_stills(self, path: Path, tabletop: Tabletop, episode: Episode) -> None:
        from smash.execution.viewing.pictures import write_stills

        times = self.recording.times
        middle = next(
            (row.begun + row.times.execution for row in episode.actions if row.action[0] == "topple"),
            times[len(times) // 2],
        )
        toppled = any(row.action[0] == "topple" for row in episode.actions)
        end = "end" if episode.success else "end (failed)"
        captions = [("start", times[0]), ("after the topple" if toppled else "on the way", middle), (end, times[-1])]
        write_stills(path, self.recording, tabletop, captions)


def _thinned(samples: Iterable[Sample]) -> Iterator[Sample]:
    """Leave out samples that follow another one too closely."""
    due = float("-inf")
    for sample in samples:
        moment = sample[0]
        if moment >= due:
            yield sample
            due = moment + TRAJECTORY_INTERVAL - 1e-6


def _require_suffix(path: Path | None, what: str, allowed: tuple[str, ...]) -> None:
    if path is not None and path.suffix not in allowed:
        raise MalformedFile(str(path), f"the name of {what} ends in {', '.join(allowed[:-1])} or {allowed[-1]}")
