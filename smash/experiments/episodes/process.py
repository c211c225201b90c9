"""Episodes in a process of their own: an `EpisodeRun` a line on standard input, its episode a line on the output."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

from smash.execution.viewing.capture import Capture
from smash.experiments.episodes.executors import executor_of
from smash.experiments.episodes.question import EpisodeRun
from smash.experiments.isolation.lifetime import end_with_parent
from smash.problem.files.instances import instance_from_document
from smash.records.episodes import Episode, episode_text
from smash.records.record import decoded


def carry_out(run: EpisodeRun) -> Episode:
    """Carry out the plan of a sweep's record."""
    instance = instance_from_document(run.record.instance_document)
    capture = Capture(replay=None if run.replay is None else Path(run.replay))
    executor = executor_of(
        instance,
        run.record.plan,
        seed=run.seed,
        replan=run.policy != "open",
        scene=run.scene,
        noise=run.noise,
        pace=run.pace,
        engine=run.engine,
        on_frame=capture.frame,
    )
    episode = executor.run()
    capture.finish(executor, episode)
    return episode


def main() -> None:
    """Answer until the input ends, or whoever asks (its process id is the argument) is gone."""
    end_with_parent(int(sys.argv[1]))
    # What libraries print must not get between the answers.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    for line in sys.stdin:
        episode = carry_out(decoded(line.encode(), EpisodeRun))
        answers.write(json.dumps(json.loads(episode_text(episode))) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
