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
    """A tower of an `on` goal, bottom first; `grounded` where its base must be at the bottom of a location."""

    blocks: tuple[int, ...]
    grounded: bool


def towers_of(problem: Numbered) -> list[Tower]:
    """Return the towers of the instance's `on` goal."""
    goal = problem.instance.goal
    assert isinstance(goal, OnGoal)
    bottom, number = frozenset(goal.bottom), problem.block_number
    return [Tower(tuple(number[block] for block in tower), tower[0] in bottom) for tower in goal.towers()]


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


def target_piles(problem: Numbered) -> Piles | None:
    """Return one pile per location whose being there fulfils the goal; None where there are too many bottoms.

    Blocks in none of the piles may lie anywhere that is not under them.
    """
    piles = goal_piles(problem)
    return _Assignment(problem).piles() if piles is None else piles


class _Assignment:
    """Gives each tower of an `on` goal a place; the floor under it is part of the location's target."""

    def __init__(self, problem: Numbered) -> None:
        self.problem = problem
        self.towers = towers_of(problem)
        self.tower_of = {block: tower for tower in self.towers for block in tower.blocks}
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
        for tower in sorted(self.towers, key=lambda tower: -len(tower.blocks)):
            if tower not in self.placed:
                self._put(tower)
        return tuple(tuple(target) for target in self.targets)

    def _anchored(self, pile: tuple[int, ...]) -> tuple[list[int], list[Tower]]:
        """Return the floor of `pile` that can stay (a tower begun on it made whole), and the towers in it."""
        floor: list[int] = []
        towers: list[Tower] = []
        height = 0
        while height < len(pile):
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
        lost = {self.tower_of[block] for block in self.targets[location] if block in self.tower_of}
        self.placed -= lost
        self.placed.add(tower)
        self.targets[location] = list(tower.blocks)
        self.claimed[location] = True

    def _is_grounded(self, target: list[int]) -> bool:
        return bool(target) and target[0] in self.tower_of and self.tower_of[target[0]].grounded

    def _put(self, tower: Tower) -> None:
        """Put a tower that may stand on anything where no other tower stands and the least is in the way."""

        def obstacles(location: int) -> tuple[bool, int, int]:
            in_the_way = len(self.problem.start[location]) - len(self.targets[location])
            return self.claimed[location], in_the_way, len(self.targets[location])

        location = min(range(len(self.targets)), key=obstacles)
        self.targets[location].extend(tower.blocks)
        self.claimed[location] = True
        self.placed.add(tower)
