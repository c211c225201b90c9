"""Plans of other planners as text: a step a line, in the spellings of Fast Downward, VAL and unified-planning."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from smash.problem.blocksworld.sexpr import shortened
from smash.problem.errors import MalformedFile

_NUMBER = r"\d+(?:\.\d*)?"
_NAME = r"[^\s(),;:\[\]]+"
_STEP = re.compile(
    rf"""(?:(?P<time>{_NUMBER})\s*:\s*)?                # VAL: `0: ` or `0.000: `
    (?:\(\s*(?P<lisp>{_NAME}(?:\s+{_NAME})*)\s*\)       # `(stack a b)`
     |(?P<name>{_NAME})\s*\(\s*(?P<list>(?:{_NAME}(?:\s*,\s*{_NAME})*)?)\s*\))  # unified-planning: `stack(a, b)`
    \s*(?:\[\s*{_NUMBER}\s*\])?                         # VAL: `[1]`, how long it takes
    \s*(?:;.*)?""",
    re.VERBOSE,
)
_CALL = re.compile(rf"({_NAME})\s*\(([^()]*)\)")
_CALLS = re.compile(rf"(?:SequentialPlan\()?\[(?P<calls>{_NAME}\([^()]*\)(?:, {_NAME}\([^()]*\))*)?\]\)?")
"""unified-planning's plan on one line: `[stack(a, b), pick-up(c)]`."""
_COST = re.compile(r";\s*cost\s*=\s*(\d+)\s*(\((?:unit|general) cost\))?", re.IGNORECASE)
_HEADING = re.compile(r"(?:SequentialPlan|TimeTriggeredPlan):?", re.IGNORECASE)
_LINE_END = re.compile(r"\r\n|\r|\n")
PddlStep = tuple[str, ...]
"""An action and its arguments, in lower case."""


@dataclass(frozen=True)
class PlanText:
    """A plan as it was written.

    Attributes:
        steps: its steps, in the order of their times.
        cost: what it says that it costs; None: nothing.
        unit: whether that cost is a count of steps.
    """

    steps: tuple[PddlStep, ...]
    cost: int | None = None
    unit: bool = False


def parse_plan(text: str, where: str) -> PlanText:
    """Read a plan.

    Raises:
        MalformedFile: where a line is neither a step nor a comment.
    """
    timed: list[tuple[float, PddlStep]] = []
    cost, unit = None, False
    for number, line in enumerate(_LINE_END.split(text), start=1):
        bare = line.strip()
        if not bare or bare.startswith(";") or _HEADING.fullmatch(bare):
            said = _COST.match(bare)
            if said is not None:
                cost, unit = int(said[1]), (said[2] or "").lower() == "(unit cost)"
            continue
        match = _STEP.fullmatch(bare)
        listed = _CALLS.fullmatch(bare) if match is None else None
        if listed is not None:
            timed += [(timed[-1][0] if timed else 0.0, step) for step in _called(listed["calls"] or "")]
            continue
        if match is None:
            allowed = "`(action a b)`, `0: (action a b)[1]` or `action(a, b)` is allowed"
            raise MalformedFile(where, f"line {number}: {shortened(bare)!r} is no step; {allowed}")
        words = match["lisp"].split() if match["lisp"] else [match["name"], *re.split(r"[\s,]+", match["list"])]
        step = tuple(word.lower() for word in words if word)
        timed.append((float(match["time"] or (timed[-1][0] if timed else 0)), step))
    timed.sort(key=lambda entry: entry[0])
    return PlanText(tuple(step for _, step in timed), cost, unit)


def _called(calls: str) -> list[PddlStep]:
    """Return the steps of `stack(a, b), pick-up(c)`."""
    return [(name.lower(), *listed.lower().replace(",", " ").split()) for name, listed in _CALL.findall(calls)]


def plan_lines(steps: Iterable[PddlStep], cost: int, *, unit: bool) -> str:
    """Return the text of a plan as Fast Downward writes it, its cost in a comment at the end."""
    lines = [f"({' '.join(step)})" for step in steps]
    return "\n".join([*lines, f"; cost = {cost} ({'unit' if unit else 'general'} cost)"]) + "\n"
