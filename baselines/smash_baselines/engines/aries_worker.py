"""The child process that runs Aries through unified-planning: `python -m smash_baselines.engines.aries_worker SECONDS`.

It reads `domain.pddl` and `problem.pddl` in its working directory and prints one JSON object a line: `{"plan":
[step, …]}` for each plan as it comes, `{"end": status}` at the end. Its server dies with it.
"""

from __future__ import annotations

import functools
import json
import os
import subprocess
import sys

from smash_baselines.engines.process import dies_with_parent
from smash_baselines.up_problem import steps_of_up_plan


def main(seconds: float) -> None:
    """Plan for at most `seconds`."""
    # The wrapper starts a server that only its garbage collection ends; a killed worker must not leave it behind.
    subprocess.Popen = functools.partial(subprocess.Popen, preexec_fn=dies_with_parent())  # type: ignore[assignment,misc]
    from unified_planning.io import PDDLReader
    from unified_planning.shortcuts import get_environment
    from up_aries import Aries

    get_environment().credits_stream = None
    problem = PDDLReader().parse_problem("domain.pddl", "problem.pddl")
    say({"read": True})
    status = "NO_ANSWER"
    with open(os.devnull, "w", encoding="utf-8") as silence:
        for result in Aries().get_solutions(problem, timeout=seconds, output_stream=silence):
            status = result.status.name
            if result.plan is not None:
                say({"plan": steps_of_up_plan(result.plan)})
    say({"end": status})


def say(words: dict[str, object]) -> None:
    """Print one line, at once."""
    print(json.dumps(words), flush=True)


if __name__ == "__main__":
    main(float(sys.argv[1]))
