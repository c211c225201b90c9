"""From a goal of any kind to one pile per location that fulfils it (the bottom part of what will lie there).

A `stacks` goal is a `positions` goal that lists every block, and a `positions` goal is its piles. For an `on`
goal the towers are given locations: where they already stand if they may, else where the least is in the way.
"""

from __future__ import annotations

from dataclasses import dataclass

from smash.problem.model import OnGoal, PositionsGoal, StacksGoal, no_goal
from smash.problem.views.numbered import Numbered

Piles = tuple[tuple[int, ...], ...]
"""One pile of block numbers per location, bottom first."""


@dataclass(frozen=True, slots=True)
class Tower:
    """A tower of an `on` goal, bottom first.

    `grounded` where its base must be at the bottom of a location, `shut` where nothing may lie on it.
    """

    blocks: tuple[int, ...]
    grounded: bool
    shut: bool = False


def towers_of(problem: Numbered) -> list[Tower]:
    """Return the towers of the instance's `on` goal."""
    goal = problem.instance.goal
    assert isinstance(goal, OnGoal)
    bottom, clear, number = frozenset(goal.bottom), frozenset(goal.clear), problem.block_number
    return [
        Tower(tuple(number[block] for block in tower), tower[0] in bottom, tower[-1] in clear)
        for tower in goal.towers()
    ]


def goal_piles(problem: Numbered) -> Piles | None:
    """Return the piles that a `stacks` or `positions` goal wants per location, or None for an `on` goal."""
    match problem.instance.goal:
        case StacksGoal(stacks):
            wanted = dict(stacks)
        case PositionsGoal() as goal:
            wanted = goal.stacks()
        case OnGoal():
            return None
        case _:
            no_goal(problem.instance.goal)
    number = problem.block_number
    return tuple(tuple(number[block] for block in wanted.get(q, ())) for q in problem.instance.locations)


def target_piles(problem: Numbered, *, falls: bool = True) -> Piles | None:
    """Return one pile per location whose being there fulfils the goal; None where the towers do not fit.

    Blocks in none of the piles may lie anywhere that is not under them, but for what `Resting` says of them.

    Args:
        problem: of any goal kind.
        falls: whether a block may come to lie in the table region. Where it may not and the goal wants blocks clear,
            every block that is outside of it is in one of the piles.
    """
    piles = goal_piles(problem)
    return _Assignment(problem, falls=falls).piles() if piles is None else piles


class Resting:
    """What an `on` goal says of where the other blocks may lie: not on a clear one, `ontable` ones on none."""

    def __init__(self, problem: Numbered) -> None:
        goal, number = problem.instance.goal, problem.block_number
        ontable, clear = (goal.ontable, goal.clear) if isinstance(goal, OnGoal) else ((), ())
        self.clear = frozenset(number[block] for block in clear)
        self.on_table = frozenset(number[block] for block in ontable)

    def wrong(self, block: int, under: int) -> bool:
        """Return whether a block may not end on another that is not below it in a tower."""
        return under in self.clear or block in self.on_table


class _Assignment:
    """Gives each tower of an `on` goal a place; the floor under it is part of the location's target.

    Where nothing falls and the goal wants blocks clear, each further block that stands is a tower of its own.
    """

    def __init__(self, problem: Numbered, *, falls: bool) -> None:
        self.problem = problem
        self.resting = Resting(problem)
        self.towers = towers_of(problem)
        self.tower_of = {block: tower for tower in self.towers for block in tower.blocks}
        if self.resting.clear and not falls:
            single = [block for pile in problem.start for block in pile if block not in self.tower_of]
            alone = {block: Tower((block,), grounded=False, shut=block in self.resting.clear) for block in single}
            self.towers += alone.values()
            self.tower_of |= alone
        self.targets: list[list[int]] = []
        self.claimed: list[bool] = []
        self.placed: set[Tower] = set()

    def piles(self) -> Piles | None:
        grounded = [tower for tower in self.towers if tower.grounded]
        if len(grounded) > self.problem.locations:
            return None
        for pile in self.problem.start:
            floor, towers = self._anchored(pile)
            self.targets.append(floor)
            self.claimed.append(bool(towers))
            self.placed.update(towers)
        for tower in grounded:
            if tower not in self.placed:
                self._ground(tower)
        for shut in (False, True):  # a shut tower comes last: it leaves no room above it
            while waiting := [tower for tower in self.towers if tower not in self.placed and tower.shut == shut]:
                if not self._put(max(waiting, key=lambda tower: len(tower.blocks))):
                    return None
        return tuple(tuple(target) for target in self.targets)

    def _anchored(self, pile: tuple[int, ...]) -> tuple[list[int], list[Tower]]:
        """Return the floor of `pile` that can stay (a tower begun on it made whole), and the towers in it."""
        floor: list[int] = []
        towers: list[Tower] = []
        height = 0
        while height < len(pile):
            if floor and self.resting.wrong(pile[height], floor[-1]):
                break
            tower = self.tower_of.get(pile[height])
            if tower is None:
                floor.append(pile[height])
                height += 1
                continue
            if tower.blocks[0] != pile[height] or (tower.grounded and height):
                break
            floor.extend(tower.blocks)
            towers.append(tower)
            if pile[height : height + len(tower.blocks)] != tower.blocks:
                break
            height += len(tower.blocks)
        return floor, towers

    def _ground(self, tower: Tower) -> None:
        """Give a tower the bottom of the location where the least that could stay is lost."""

        def loss(location: int) -> tuple[int, int]:
            return len(self.targets[location]), len(self.problem.start[location])

        free = [q for q, target in enumerate(self.targets) if not self._is_grounded(target)]
        location = min(free, key=loss)
        self._cut(location, 0)
        self.placed.add(tower)
        self.targets[location] = list(tower.blocks)
        self.claimed[location] = True

    def _is_grounded(self, target: list[int]) -> bool:
        return bool(target) and target[0] in self.tower_of and self.tower_of[target[0]].grounded

    def _cut(self, location: int, height: int) -> None:
        """Take what is above some height out of a target; its towers need another place."""
        lost = {self.tower_of[block] for block in self.targets[location][height:] if block in self.tower_of}
        self.placed -= lost
        del self.targets[location][height:]

    def _put(self, tower: Tower) -> bool:
        """Put a tower that may stand on anything where no other tower stands and the least is in the way."""

        def obstacles(location: int) -> tuple[bool, int, int]:
            in_the_way = len(self.problem.start[location]) - len(self.targets[location])
            return self.claimed[location], in_the_way, len(self.targets[location])

        free = [q for q, target in enumerate(self.targets) if not target or target[-1] not in self.resting.clear]
        if not free:
            location = self._opened(towers=not tower.shut)
            if location is None:
                return False
            free = [location]
        location = min(free, key=obstacles)
        self.targets[location].extend(tower.blocks)
        self.claimed[location] = True
        self.placed.add(tower)
        return True

    def _opened(self, *, towers: bool) -> int | None:
        """Take a clear top away where it may stand elsewhere; return the location, or None where there is none.

        One of no tower goes first: it can fall. That of a tower goes only where `towers` says so.
        """
        best: tuple[bool, int, int, int] | None = None
        for location, target in enumerate(self.targets):
            tower = self.tower_of.get(target[-1])
            if tower is not None and (tower.grounded or not towers):
                continue
            height = len(target) - (1 if tower is None else len(tower.blocks))
            key = (tower is not None, len(target) - height, location, height)
            best = key if best is None else min(best, key)
        if best is None:
            return None
        self._cut(best[2], best[3])
        return best[2]
