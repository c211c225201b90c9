"""`clingo`: answer set programming; the program is `steps.lp`, the facts are made here."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from time import perf_counter
from typing import Any, ClassVar

from smash_baselines.paradigms.growing import Ended, Found, GrowingPlanner, Horizon
from smash_baselines.paradigms.task import Fall, Move, Step, Task

PROGRAM = Path(__file__).parent / "steps.lp"


class ClingoPlanner(GrowingPlanner):
    """A logic program of growing horizon."""

    summary: ClassVar[str] = "answer set programming (clingo): what stands on what, step by step"
    name: ClassVar[str] = "clingo"
    module: ClassVar[str] = "clingo"
    cells_per_second: ClassVar[int] = 20_000

    def prepare(self) -> None:
        """Load clingo."""
        import clingo  # noqa: F401

    def solve_horizon(self, horizon: Horizon, found: Found) -> Ended:
        """Ground the program of a horizon and solve it."""
        import clingo

        began = perf_counter()
        arguments = [f"--parallel-mode={min(64, horizon.settings.threads)}", f"--seed={horizon.settings.seed}"]
        control = clingo.Control([*arguments, "-c", f"h={horizon.steps}"], logger=lambda code, words: None)
        control.add("base", [], "\n".join(facts(horizon)) + PROGRAM.read_text(encoding="utf-8"))
        control.ground([("base", [])])
        left = horizon.seconds - (perf_counter() - began)
        if left <= 0:
            return "stopped"
        with control.solve(on_model=lambda model: found(steps(model)), async_=True) as handle:
            ended = handle.wait(left)
            if not ended:
                handle.cancel()
            result = handle.get()
        return "exhausted" if ended and result.exhausted else "stopped"


def facts(horizon: Horizon) -> Iterator[str]:
    """Yield the facts of a horizon, one a line."""
    task: Task = horizon.task
    yield f"block(0..{task.blocks - 1}). cap({task.cap})."
    for floor in task.floors:
        yield f"floor({floor})."
    for buffer in task.buffers:
        yield f"buffer({buffer})."
    for block, under in enumerate(task.below):
        yield f"lies({block},0)." if under == task.table else f"on({block},{under},0)."
        places = task.wanted[block]
        if places is not None:
            yield f"goal({block})."
            yield from (f"fits({block},{thing})." for thing in sorted(places) if thing != task.table)
            if task.table in places:
                yield f"may_lie({block})."
    yield from (f"bare({block})." for block in sorted(task.bare))
    yield from (f"fixed({block})." for block in sorted(task.fixed))
    yield from (f"placed({block})." for block in sorted(task.placed))
    if task.located:
        yield "located."
    if horizon.below is not None:
        yield f"below({horizon.below})."


def steps(model: Any) -> list[Step]:
    """Read the steps off an answer set."""
    found: dict[int, Step] = {}
    picked, put = {}, {}
    for atom in model.symbols(shown=True):
        what, (subject, time) = atom.name, (argument.number for argument in atom.arguments)
        if what == "pick":
            picked[time] = subject
        elif what == "put":
            put[time] = subject
        else:
            found[time] = Fall(subject)
    found |= {time: Move(block, put[time]) for time, block in picked.items()}
    return [found[time] for time in sorted(found)]
