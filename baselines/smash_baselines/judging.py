"""The steps that judge the words of a goal (`smash_baselines.goal_words`) once a plan has reached it."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from smash.problem.model import State
from smash_baselines.goal_words import FINISH, RESTS, word_names, words_of
from smash_baselines.names import Step
from smash_baselines.parts.layout import Layout
from smash_baselines.task import PddlTask


def judging_steps(state: State, task: PddlTask) -> Iterator[Step]:
    """Yield the steps that judge the words of the task's goal in a state where it holds; none where it has no words."""
    objects = word_names(task.instance.goal)
    if not objects:
        return
    yield (FINISH, objects[0])
    for (word, later), (says, block) in zip(pairwise(objects), words_of(task.instance.goal), strict=True):
        short = task.names.blocks[block]
        if block in state.table:
            yield ("rests-in-region" if says == RESTS else "clear-in-region", short, word, later)
        elif says == RESTS:
            yield ("rests-at-bottom", short, word, later)
        else:
            yield (*_clear(state, task, block), word, later)


def _clear(state: State, task: PddlTask, block: str) -> Step:
    """Return the way in which a block is clear outside of the table region, without the words."""
    short, layout = task.names.blocks[block], Layout(task.instance, task.names)
    carrier = next((name for name, held in state.carried.items() if block in held), None)
    if carrier is not None:
        return ("clear-on-carrier", short, layout.carriers[carrier])
    place = next(at for at, pile in state.piles.items() if block in pile)
    if task.encoding.parts:
        return ("clear-on-top", short, layout.region(place))
    if task.encoding.chain:
        return ("clear-on-top", short, "stacks" if place in task.names.locations else "buffers")
    return ("clear-on-top", short)
