"""One simulation as data: an episode or a trial of a topple, done in processes of its own like a planner's run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import msgspec

from smash.experiments.episodes.question import EpisodeRun, TrialRun
from smash.experiments.isolation.job import DEFAULT_MEMORY
from smash.problem.files.typed import typed

LONGEST = 900.0
"""Seconds of wall time after which a simulation is given up."""


@dataclass(frozen=True, slots=True)
class Simulation:
    """What a guardian guards (`smash.experiments.isolation.work.Work`); `memory` in MiB over all of its processes."""

    done_by: ClassVar[str] = "smash.experiments.episodes.simulating:simulate"
    loaded_by: ClassVar[str] = "smash.experiments.episodes.simulating:load"

    question: EpisodeRun | TrialRun
    budget: float = LONGEST
    memory: int = DEFAULT_MEMORY

    def document(self) -> dict[str, Any]:
        """Return it as JSON data."""
        return {"question": msgspec.to_builtins(self.question), "budget": self.budget, "memory": self.memory}

    @classmethod
    def from_document(cls, document: dict[str, Any]) -> Self:
        """Build it from its JSON data."""
        question = typed(document["question"], EpisodeRun | TrialRun)
        return cls(question, document["budget"], document["memory"])
