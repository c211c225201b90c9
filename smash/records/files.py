"""The files of records that a results directory may hold, and the type of each one's lines."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from smash.records.episodes import EPISODE_RUN_FORMAT, EpisodeRecord
from smash.records.runs import RUN_FORMAT, RunRecord
from smash.records.trials import TRIAL_FORMAT, Trial

R = TypeVar("R", RunRecord, EpisodeRecord, Trial)


@dataclass(frozen=True, slots=True)
class RecordFile(Generic[R]):
    """A kind of file.

    Attributes:
        name: In the results directory.
        format: What each line says of itself.
        record: The type of its lines.
        one: What one line tells of, in a word.
    """

    name: str
    format: str
    record: type[R]
    one: str

    def path(self, results: Path) -> Path:
        """Return where it lies in a results directory."""
        return results / self.name

    def aside(self, results: Path) -> Path:
        """Return the file of the damaged lines that earlier starts have set aside."""
        return self.path(results).with_suffix(".damaged")

    def redone(self, results: Path) -> Path:
        """Return the file of the records that were asked to be done again."""
        return self.path(results).with_suffix(".redone")


RUNS = RecordFile("runs.jsonl", RUN_FORMAT, RunRecord, "run")
EPISODES = RecordFile("episodes.jsonl", EPISODE_RUN_FORMAT, EpisodeRecord, "episode")
TRIALS = RecordFile("trials.jsonl", TRIAL_FORMAT, Trial, "trial")
