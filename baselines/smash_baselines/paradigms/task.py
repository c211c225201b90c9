"""A problem as what stands on what: blocks, floors and the table region by number, alike for the three paradigms.

Things are the blocks 0 to n - 1, the floors n to n + p - 1 (of the stacks, then of the buffers that can be of use), and
the table region, n + p. A state says what each block stands on; a step is a transfer or a topple.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from smash.problem.actions.topple import Topple
from smash.problem.model import TABLE, Action, OnGoal, Pick, Place, PositionsGoal, StacksGoal, State, no_goal
from smash.problem.problem import Problem


@dataclass(frozen=True, slots=True)
class Move:
    """A transfer of a block to a thing, which is a floor or a block."""

    block: int
    onto: int


@dataclass(frozen=True, slots=True)
class Fall:
    """A topple in which a block and all that stands on it falls."""

    lowest: int


Step = Move | Fall


@dataclass(frozen=True)
class Task:
    """What a model is built from.

    Attributes:
        problem: what it is made of; the hand is empty at the start.
        places: the locations, stacks first.
        stacks: how many of them are stacks.
        below: per block the thing that it stands on at the start.
        wanted: per block the things that it may stand on at the end; None: any.
        bare: blocks on which nothing stands at the end.
        located: whether the goal names locations: what is home over what is home then stays in some cheapest plan.
        fixed: blocks that are home at the start.
        placed: blocks that every plan transfers at least once.
        cap: most blocks of one topple; 0 where none is allowed.
    """

    problem: Problem
    places: tuple[str, ...]
    stacks: int
    below: tuple[int, ...]
    wanted: tuple[frozenset[int] | None, ...]
    bare: frozenset[int]
    located: bool
    fixed: frozenset[int]
    placed: frozenset[int]
    cap: int

    @property
    def blocks(self) -> int:
        """Number of blocks n."""
        return len(self.below)

    @property
    def table(self) -> int:
        """The number of the table region."""
        return self.blocks + len(self.places)

    @property
    def floors(self) -> range:
        """The numbers of the floors."""
        return range(self.blocks, self.table)

    @property
    def buffers(self) -> range:
        """The numbers of the floors of buffers."""
        return range(self.blocks + self.stacks, self.table)

    def least_cost(self, steps: int) -> int:
        """Return a cost that no plan of at least so many steps is below: the rest are topples, if there are any."""
        return (len(self.placed) + max(steps, len(self.placed))) if self.cap else 2 * max(steps, len(self.placed))

    def actions(self, steps: Sequence[Step]) -> tuple[Action, ...]:
        """Return the plan of some steps; buffers are those of the places.

        Raises:
            IllegalAction: where the law refuses one.
        """
        names, law = self.problem.instance.blocks, self.problem.law
        state, plan = State.start_of(self.problem.instance), list[Action]()
        for step in steps:
            made: list[Action]
            match step:
                case Move(block, onto):
                    name = names[block]
                    source = next((place for place, pile in state.piles.items() if name in pile), TABLE)
                    if onto < self.blocks:
                        under = names[onto]
                        target = next(place for place, pile in state.piles.items() if under in pile)
                    else:
                        target = self.places[onto - self.blocks]
                    made = [Pick(name, source), Place(name, target)]
                case Fall(lowest):
                    name = names[lowest]
                    location = next(place for place, pile in state.piles.items() if name in pile)
                    made = [Topple(location, state.piles[location].index(name) + 1)]
            for action in made:
                law.apply(state, action)
            plan += made
        return tuple(plan)


def task_of(problem: Problem) -> Task:
    """Return the task of a problem whose hand is empty at the start."""
    instance, options = problem.instance, problem.options
    count = len(instance.blocks)
    used = [buffer for buffer in instance.buffers if instance.start[buffer]]
    idle = [buffer for buffer in instance.buffers if not instance.start[buffer]][:count]
    kept = {*used, *idle}
    places = (*instance.stacks, *(buffer for buffer in instance.buffers if buffer in kept))
    number = {block: index for index, block in enumerate(instance.blocks)}
    below = [count + len(places)] * count
    for index, place in enumerate(places):
        under = count + index
        for block in instance.start[place]:
            below[number[block]], under = under, number[block]
    floors = frozenset(range(count, count + len(places)))
    wanted, bare = _wanted(problem, number, {place: count + index for index, place in enumerate(places)}, floors)
    located = not isinstance(instance.goal, OnGoal)
    return Task(
        problem=problem,
        places=places,
        stacks=len(instance.stacks),
        below=tuple(below),
        wanted=tuple(wanted),
        bare=bare,
        located=located,
        fixed=_at_home(below, wanted, floors) if located else frozenset(),
        placed=_placed(below, wanted, bare, count + len(places)),
        cap=0 if not options.topple else min(count, options.max_topple or count),
    )


def _wanted(
    problem: Problem, number: dict[str, int], floor: dict[str, int], floors: frozenset[int]
) -> tuple[list[frozenset[int] | None], frozenset[int]]:
    """Return what each block may stand on at the end, and the blocks on which nothing stands then."""
    wanted: list[frozenset[int] | None] = [None] * len(number)
    match problem.instance.goal:
        case StacksGoal() | PositionsGoal() as goal:
            piles = goal.stacks() if isinstance(goal, PositionsGoal) else goal.stacks
            for place, pile in piles.items():
                under = floor[place]
                for block in pile:
                    wanted[number[block]], under = frozenset((under,)), number[block]
            return wanted, frozenset()
        case OnGoal() as goal:
            table = frozenset((len(number) + len(floor),))
            for block in goal.ontable:
                wanted[number[block]] = floors | table
            for block in goal.bottom:
                wanted[number[block]] = floors
            for block, under_name in goal.on.items():
                wanted[number[block]] = frozenset((number[under_name],))
            return wanted, frozenset(number[block] for block in goal.clear)
        case _:
            no_goal(problem.instance.goal)


def _at_home(below: Sequence[int], wanted: Sequence[frozenset[int] | None], floors: frozenset[int]) -> frozenset[int]:
    """Return the blocks of the correct bottom parts of the goal's piles, which need not move."""
    home: set[int] = set()
    above = {under: block for block, under in enumerate(below) if under in floors or under < len(below)}
    for floor in floors:
        under = floor
        while (block := above.get(under)) is not None and wanted[block] == frozenset((under,)):
            home.add(block)
            under = block
    return frozenset(home)


def _placed(
    below: Sequence[int], wanted: Sequence[frozenset[int] | None], bare: frozenset[int], table: int
) -> frozenset[int]:
    """Return the blocks that every plan transfers: they have to leave what they stand on, and not for the table."""
    taken = {next(iter(places)) for places in wanted if places is not None and len(places) == 1}
    leaves = {
        block
        for block, under in enumerate(below)
        if (wanted[block] is not None and under not in (wanted[block] or ()))
        or under in bare
        or (under in taken and under < table and wanted[block] != frozenset((under,)))
    }
    above = {under: block for block, under in enumerate(below) if under < len(below)}
    waiting = list(leaves)
    while waiting:
        over = above.get(waiting.pop())
        if over is not None and over not in leaves:
            leaves.add(over)
            waiting.append(over)
    return frozenset(block for block in leaves if (places := wanted[block]) is not None and table not in places)
