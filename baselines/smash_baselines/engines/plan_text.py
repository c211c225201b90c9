"""Plans as planners of all kinds write them: one step a line, in a file or in what they print."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator

from smash_baselines.names import Step
from smash_baselines.steps import parse_step

_IN_BRACKETS = re.compile(r"(?:\d+(?:\.\d+)?\s*:\s*)?\(([^()]+)\)\s*(?:\[[\d.]+\])?")
"""`(pick b02 b01)`, as VAL and the IPC have it, perhaps with numbers or times: `0.001: (pick b02 b01) [1]`."""
_WITH_COST = re.compile(r"([^()\[\]]+?)\s*\(\d+\)")
"""`pick b02 b01 (1)`, as the log of Fast Downward has it."""


def step_in(line: str, actions: Collection[str], *, bare: bool = False) -> Step | None:
    """Return the step that a line says, or None.

    Args:
        line: one line.
        actions: the names of the domain's actions.
        bare: whether a step may stand without brackets and cost: in files that hold a plan and nothing else.
    """
    text = line.split(";", 1)[0].strip()
    form = _IN_BRACKETS.fullmatch(text) or _WITH_COST.fullmatch(text)
    if form is None and not bare:
        return None
    step = parse_step(form[1] if form else text)
    return step if step and step[0] in actions else None


def steps_in(text: str, actions: Collection[str]) -> list[Step]:
    """Return the steps of a plan file."""
    return [step for line in text.splitlines() if (step := step_in(line, actions, bare=True)) is not None]


def plans_in(lines: Iterable[str], actions: Collection[str]) -> Iterator[list[Step]]:
    """Yield each plan that a program prints, when it is complete: lines one after the other that each say a step.

    Args:
        lines: what it prints, as it comes.
        actions: the names of the domain's actions.
    """
    steps: list[Step] = []
    for line in lines:
        step = step_in(line, actions)
        if step is not None:
            steps.append(step)
        elif steps:
            yield steps
            steps = []
    if steps:
        yield steps
