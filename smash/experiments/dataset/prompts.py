"""A problem told to whoever is to plan it from a text: in words, or in PDDL."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from smash.problem.errors import Unsupported
from smash.problem.model import Instance, OnGoal, PlanOptions, PositionsGoal, StacksGoal, no_goal
from smash.problem.problem import Problem

if TYPE_CHECKING:
    from smash_baselines.task import PddlTask

RULES, TOPPLE = (Path(__file__).with_name(name) for name in ("rules.txt", "rules-of-topple.txt"))
"""The law in words; what stands in braces is filled in."""
ANSWER = "Answer with the plan alone, as one JSON list of actions, in their order, for example [{example}]."


def prompt_in_words(instance: Instance, options: PlanOptions | None = None) -> str:
    """Return a problem in English: the rules, the start, the goal, and how to answer.

    Args:
        instance: what to plan; with pick, place and topple at cost 1.
        options: what the plan may use; everything, where None.

    Raises:
        Unsupported: where the instance has other actions or costs.
    """
    options = options or PlanOptions()
    if not instance.costs.plain or instance.carriers or instance.capacities:
        raise Unsupported(f"{instance.name}: prompts tell of pick, place and topple at cost 1 alone")
    region = "blocks that are toppled land there." if options.topple else "blocks may lie there at the start."
    cap = "" if options.max_topple is None else f", and at most {options.max_topple}"
    topple = (
        TOPPLE.read_text(encoding="utf-8").format(cap=cap, stacks=_listed(instance.stacks)) if options.topple else ""
    )
    rules = RULES.read_text(encoding="utf-8").format(places=_listed(instance.locations), region=region, topple=topple)
    goal = list(_goal(instance)) or ["- nothing is asked"]
    parts = [rules, "Start:", *_start(instance), "Goal:", *goal, "", ANSWER.format(example=_example(instance))]
    return "\n".join(parts) + "\n"


def prompt_in_pddl(instance: Instance, options: PlanOptions | None = None) -> str:
    """Return a problem as a PDDL domain and problem, and how to answer.

    Args:
        instance: what to plan.
        options: what the plan may use; everything, where None.

    Raises:
        SmashError: where no encoding takes it.
    """
    task = pddl_task(instance, options or PlanOptions())
    ask = "Solve this PDDL problem with as low a total-cost as you can."
    answer = "Answer with the plan alone: one action a line, as (name argument ...)."
    return f"{ask}\n\n{task.domain_text}\n{task.problem_text}\n{answer}\n"


def pddl_task(instance: Instance, options: PlanOptions) -> PddlTask:
    """Return a problem in the encoding of a prompt in PDDL: topple is one action; a chain with caps or costs.

    Raises:
        SmashError: where the encoding does not take it.
    """
    from smash_baselines.encodings import COMPOSED
    from smash_baselines.task import compile_instance

    chain = options.max_topple is not None or not Problem(instance, options).plain
    return compile_instance(instance, options, COMPOSED if chain else "conditional")


def _example(instance: Instance) -> str:
    """Return a pick and a place for an answer; none where there are no blocks or places."""
    if not instance.blocks or not instance.locations:
        return ""
    block, place = _name(instance.blocks[0]), _name(instance.locations[0])
    return f'["pick", {block}, {place}], ["place", {block}, {place}]'


def _start(instance: Instance) -> Iterator[str]:
    for location in instance.locations:
        pile = instance.start.get(location, ())
        yield f"- {_name(location)}: " + (f"from the bottom to the top {_listed(pile)}" if pile else "empty")
    if instance.table:
        yield f"- table region: {_listed(instance.table)}"
    if instance.hand is not None:
        yield f"- the gripper holds {_name(instance.hand)}"


def _goal(instance: Instance) -> Iterator[str]:
    match instance.goal:
        case StacksGoal() as goal:
            for location, pile in goal.stacks.items():
                if pile:
                    yield f"- {_name(location)} holds exactly, from the bottom to the top: {_listed(pile)}"
            yield "- every other place and the table region are empty"
        case PositionsGoal() as goal:
            for block, (location, height) in goal.positions.items():
                yield f"- {_name(block)} is at height {height} of {_name(location)}"
            if goal.positions:
                yield "- all other blocks may be anywhere, in the table region too"
        case OnGoal() as goal:
            yield from (f"- {_name(upper)} lies directly on {_name(under)}" for upper, under in goal.on.items())
            yield from (f"- {_name(block)} is the lowest block of some place" for block in goal.bottom)
            yield from (
                f"- {_name(block)} is the lowest block of some place, or in the table region" for block in goal.ontable
            )
            yield from (f"- nothing lies on {_name(block)}" for block in goal.clear)
        case _:
            no_goal(instance.goal)


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(map(_name, names))


def _name(name: str) -> str:
    return json.dumps(name, ensure_ascii=False)
