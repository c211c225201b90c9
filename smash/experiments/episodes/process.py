"""Episodes in a process of their own: a question a line as JSON on standard input, its episode a line on the output."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Any

from smash.execution.episode import Episode, episode_text
from smash.execution.executor import Executor
from smash.execution.policy import OPEN
from smash.execution.scene.scene_file import default_scene, read_scene
from smash.execution.viewing.capture import Capture
from smash.experiments.episodes.episodes import REPLAN_BUDGET
from smash.experiments.episodes.replanning import replanner
from smash.experiments.isolation.lifetime import end_with_parent
from smash.experiments.sweeps.records import recorded_plan
from smash.problem.files.instances import instance_from_document


def run_question(question: dict[str, Any]) -> Episode:
    """Carry out the plan of a sweep's record: its `seed`, `policy`, `scene`, `replay` (paths or None)."""
    record = question["record"]
    instance = instance_from_document(record["instance_document"])
    plan = recorded_plan(record)
    scene = default_scene() if question["scene"] is None else read_scene(question["scene"])
    seed, is_open = question["seed"], question["policy"] == "open"
    replay = question.get("replay")
    capture = Capture(replay=None if replay is None else Path(replay))
    executor = Executor(
        instance,
        plan,
        scene,
        seed=seed,
        policy=OPEN if is_open else None,
        replanner=None if is_open else replanner(plan.planner, REPLAN_BUDGET, seed),
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
        episode = run_question(json.loads(line))
        answers.write(json.dumps(json.loads(episode_text(episode))) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
