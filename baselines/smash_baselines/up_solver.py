"""The child process in which the unified-planning engine plans: `python -m smash_baselines.up_solver`.

It reads `job.json` in its working directory, and prints one JSON object a line: `{"ready": true}` when its clock
starts, `{"actions": [action, …]}` for each plan as it comes, `{"end": plan}` or `{"failed": kind, "reason": words}` at
the end. The caller stops it by ending it.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from smash.planners.protocol import Settings, ask
from smash.planners.registry import get_planner, make_ready
from smash.problem.errors import SmashError, Unsupported
from smash.problem.files.instances import instance_document, instance_from_document
from smash.problem.files.plans import action_list, plan_document
from smash.problem.model import Action, PlanOptions
from smash.problem.problem import Problem

JOB = "job.json"


def job_document(problem: Problem, planner: str, budget: float) -> dict[str, Any]:
    """Return a job as JSON data.

    Args:
        problem: what to plan.
        planner: the planner's name.
        budget: seconds of wall time.
    """
    options = problem.options
    return {
        "instance": instance_document(problem.instance),
        "options": {"topple": options.topple, "max_topple": options.max_topple},
        "planner": planner,
        "budget": budget,
    }


def main() -> None:
    """Plan the job of the working directory."""
    job = json.loads(Path(JOB).read_text(encoding="utf-8"))
    problem = Problem(instance_from_document(job["instance"]), PlanOptions(**job["options"]))
    try:
        planner = get_planner(job["planner"])
        make_ready(planner, job["planner"], problem, Settings())
        _say({"ready": True})
        answer = ask(planner, problem, Settings(), job["budget"], _report, name=job["planner"])
        _say({"end": plan_document(answer)})
    except Unsupported as error:
        _say({"failed": "unsupported", "reason": str(error)})
    except SmashError as error:
        _say({"failed": "error", "reason": str(error)})


def _report(seconds: float, cost: int, actions: Sequence[Action]) -> None:
    _say({"actions": [action_list(action) for action in actions]})


def _say(words: dict[str, Any]) -> None:
    print(json.dumps(words), flush=True)


if __name__ == "__main__":
    main()
