"""What is asked of a process that runs episodes: one plan, how it is to be carried out."""

from __future__ import annotations

import msgspec

from smash.records.runs import RunRecord


class EpisodeRun(msgspec.Struct, frozen=True):
    """One episode to be run.

    Attributes:
        record: The run that holds its plan.
        seed: Of the episode.
        policy: Of `smash.experiments.episodes.series.POLICIES`.
        scene: The scene file, or None for the built-in scene.
        told: What `told_apart` says of the scene, or None for the built-in scene.
        noise: In place of the scene's own, or None.
        pace: The same.
        replay: The page to write, or None.
        engine: What simulates it.
    """

    record: RunRecord
    seed: int
    policy: str
    scene: str | None
    told: str | None = None
    replay: str | None = None
    noise: str | None = None
    pace: float | None = None
    engine: str = "pybullet"

    @property
    def key(self) -> str:
        """Names the episode for good."""
        words = [self.record.key, self.policy, str(self.seed), *filter(None, [self.told])]
        return "/".join(words if self.engine == "pybullet" else [*words, self.engine])
