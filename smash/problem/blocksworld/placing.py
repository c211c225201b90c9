"""Where the towers of a classical problem stand: on stacks, then on buffers."""

from __future__ import annotations

from dataclasses import dataclass

from smash.problem.blocksworld.problem import BlocksProblem
from smash.problem.errors import SmashError
from smash.problem.making import make_instance
from smash.problem.model import Instance
from smash.problem.words import counted


@dataclass(frozen=True)
class Placed:
    """An instance that was made of a problem, and how many of its towers begin on a buffer."""

    instance: Instance
    on_buffers: int


def placed(
    problem: BlocksProblem, stacks: int | None = None, buffers: int | None = None, name: str | None = None
) -> Placed:
    """Give every tower a place, the tallest first (those of one height in the order of `:init`).

    Args:
        problem: the problem.
        stacks: how many stacks there are; None: as many as blocks.
        buffers: how many buffers; None: none.
        name: the instance's name; None: the problem's.

    Raises:
        SmashError: where there are more towers than places, with the flags that would fit.
    """
    stack_count = max(1, len(problem.blocks)) if stacks is None else stacks
    buffer_count = buffers or 0
    towers = sorted(problem.start.towers(), key=len, reverse=True)
    if len(towers) > stack_count + buffer_count:
        more = len(towers) - stack_count
        raise SmashError(
            f"{problem.where}: {len(towers)} towers at the start, {counted(stack_count + buffer_count, 'place')}; "
            f"`--stacks {len(towers)}`, or `--stacks {stack_count} --buffers {more}`, would fit"
        )
    stack_names = [f"p{number}" for number in range(1, stack_count + 1)]
    buffer_names = [f"u{number}" for number in range(1, buffer_count + 1)]
    instance = make_instance(
        name=problem.name if name is None else name,
        blocks=problem.blocks,
        stacks=stack_names,
        buffers=buffer_names,
        start=dict(zip([*stack_names, *buffer_names], towers, strict=False)),
        goal=problem.goal,
        hand=problem.start.held,
        where=problem.where,
    )
    return Placed(instance, max(0, len(towers) - stack_count))
