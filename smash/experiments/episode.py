"""One episode in a process of its own: the question as JSON on standard input, the episode as JSON on the output."""

from __future__ import annotations

import json
import sys

from smash.execution.episode import episode_text
from smash.execution.executor import Executor
from smash.execution.policy import OPEN
from smash.execution.scene_file import default_scene, read_scene
from smash.experiments.episodes import REPLAN_BUDGET
from smash.experiments.replanning import replanner
from smash.problem.files import PLAN_FORMAT_2, instance_from_document, plan_from_document


def main() -> None:
    """Answer one question."""
    question = json.load(sys.stdin)
    record = question["record"]
    instance = instance_from_document(record["instance_document"])
    fields = ("instance", "planner", "topple", "max_topple", "status", "cost", "actions", "lower_bound", "bound_origin")
    filed = {field: record[field] for field in fields} | {"without": record.get("without", [])}
    plan = plan_from_document({"format": PLAN_FORMAT_2, **filed})
    scene = default_scene() if question["scene"] is None else read_scene(question["scene"])
    seed, is_open = question["seed"], question["policy"] == "open"
    executor = Executor(
        instance,
        plan,
        scene,
        seed=seed,
        policy=OPEN if is_open else None,
        replanner=None if is_open else replanner(plan.planner, plan.options, REPLAN_BUDGET, seed),
    )
    print(json.dumps(json.loads(episode_text(executor.run()))))


if __name__ == "__main__":
    main()
