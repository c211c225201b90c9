"""A stretch of a plan as a problem of its own: the blocks that move in it, between two arrangements that are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from smash.planners.neighbourhood.course import Arrangement
from smash.problem.model import Instance, OnGoal, StacksGoal
from smash.problem.views.numbered import ON_TABLE, TOPPLE, Numbered, Step
from smash.problem.views.targets import Piles, goal_piles, towers_of

SPARE = 3
"""Locations of each kind that a window may use though its steps do not."""


def final_piles(problem: Numbered, end: Arrangement) -> Piles | None:
    """Return per location what has to lie there at the end of a plan, the rest anywhere, if it is to end like this one.

    None where some block has to lie in the table region.

    Args:
        problem: the numbered instance.
        end: the last arrangement of a plan.
    """
    wanted = goal_piles(problem)
    if wanted is not None:
        return wanted
    goal = problem.instance.goal
    assert isinstance(goal, OnGoal)
    if goal.ontable or goal.clear:  # they ask something of blocks of no tower, too
        return None if end.table else tuple(tuple(pile) for pile in end.piles)
    listed = {block for tower in towers_of(problem) for block in tower.blocks}
    heights = [max((level + 1 for level, block in enumerate(pile) if block in listed), default=0) for pile in end.piles]
    return tuple(tuple(pile[:height]) for pile, height in zip(end.piles, heights, strict=True))


@dataclass(frozen=True, slots=True)
class Window:
    """The problem of getting from one arrangement of a plan to a later one.

    Attributes:
        problem: the blocks that move, what lies on them, and the locations that are touched, with a few more.
        blocks: per block of `problem` its number in the plan.
        locations: the same per location.
        whole: whether every block has a place to be at in the end.
    """

    problem: Numbered
    blocks: tuple[int, ...]
    locations: tuple[int, ...]
    whole: bool

    def in_plan(self, steps: Sequence[Step]) -> list[Step]:
        """Return steps of the window's problem as steps of the plan."""
        return [
            (TOPPLE, self.locations[second], third)
            if first == TOPPLE
            else (self.blocks[first], ON_TABLE if second == ON_TABLE else self.locations[second], self.locations[third])
            for first, second, third in steps
        ]

    def reversed(self) -> Numbered:
        """Return the problem the other way round: its plans without topple, from the last step to the first, serve."""
        instance = self.problem.instance
        assert isinstance(instance.goal, StacksGoal)
        goal = StacksGoal({location: pile for location, pile in instance.start.items() if pile})
        start = {location: instance.goal.stacks.get(location, ()) for location in instance.locations}
        return Numbered.of(Instance(instance.name, instance.blocks, instance.stacks, instance.buffers, start, goal))


def window_of(
    problem: Numbered, begin: Arrangement, steps: Sequence[Step], final: Piles | None = None
) -> Window | None:
    """Return the problem of some steps of a plan; None where one of its blocks has to end in the table region.

    Args:
        problem: what is planned.
        begin: the arrangement before the steps.
        steps: some of a plan, one after the other.
        final: what has to lie at each location after them, the rest anywhere; None: all as they leave it.
    """
    low = [len(pile) for pile in begin.piles]
    end = begin.copy()
    touched: set[int] = set()
    loose: set[int] = set()
    for step in steps:
        end.take(step)
        first, second, third = step
        if second == ON_TABLE:
            loose.add(first)
        else:
            touched.add(second)
            low[second] = min(low[second], len(end.piles[second]))
        if first != TOPPLE:
            touched.add(third)
    start = {at: tuple(begin.piles[at][low[at] :]) for at in touched}
    wanted = {at: tuple((end.piles if final is None else final)[at][low[at] :]) for at in touched}
    blocks = tuple(sorted({block for pile in start.values() for block in pile} | (loose & begin.table)))
    whole = sum(map(len, wanted.values())) == len(blocks)
    if final is None and not whole:
        return None
    locations = _locations(problem, touched)
    name = {block: str(number) for number, block in enumerate(blocks)}
    places = tuple(str(at) for at in locations)
    stacks = sum(at < problem.stacks for at in locations)
    instance = Instance(
        name="window",
        blocks=tuple(name.values()),
        stacks=places[:stacks],
        buffers=places[stacks:],
        start={str(at): tuple(name[block] for block in start.get(at, ())) for at in locations},
        goal=StacksGoal({str(at): tuple(name[block] for block in pile) for at, pile in wanted.items() if pile}),
        table=tuple(name[block] for block in blocks if block in begin.table),
    )
    return Window(Numbered.of(instance), blocks, locations, whole)


def _locations(problem: Numbered, touched: set[int]) -> tuple[int, ...]:
    """Return the locations of a window in their order."""
    spare: list[int] = []
    for first, end in ((0, problem.stacks), (problem.stacks, problem.locations)):
        others = (at for at in range(first, end) if at not in touched)
        spare += [at for at, _ in zip(others, range(SPARE), strict=False)]
    return tuple(sorted(touched | set(spare)))
