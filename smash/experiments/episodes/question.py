"""What is asked of a process that simulates: one plan and how it is to be carried out, or one topple."""

from __future__ import annotations

from typing import Any

import msgspec

from smash.records.episodes import ROBOT
from smash.records.runs import RunRecord
from smash.records.trials import Key


class EpisodeRun(msgspec.Struct, frozen=True, tag="episode"):
    """One episode to be run.

    Attributes:
        record: The run that holds its plan.
        seed: Of the episode.
        policy: Of `smash.experiments.episodes.series.POLICIES`.
        scene: What records call the scene, or None for the built-in scene.
        told: What `told_apart` says of the scene, or None for the built-in scene.
        tabletop: The scene itself as plain data, or None for the built-in scene.
        replay: The page to write, or None.
        engine: What simulates it.
        robot: What records call the robot.
    """

    record: RunRecord
    seed: int
    policy: str
    scene: str | None = None
    told: str | None = None
    tabletop: dict[str, Any] | None = None
    replay: str | None = None
    engine: str = "pybullet"
    robot: str = ROBOT

    @property
    def key(self) -> str:
        """Names the episode for good."""
        words = [self.record.key, self.policy, str(self.seed), *filter(None, [self.told])]
        words += [] if self.engine == "pybullet" else [self.engine]
        words += [] if self.robot == ROBOT else [self.robot]
        return "/".join(words)


class TrialRun(msgspec.Struct, frozen=True, tag="trial"):
    """One trial of a topple to be run.

    Attributes:
        key: As that of its record: scene, stack, height of the cut, number falling, seed.
        tabletop: The scene as plain data.
        engine: What simulates it.
    """

    key: Key
    tabletop: dict[str, Any]
    engine: str
