"""Final arrangements of an `on` goal on one or two locations without topple: one line of blocks that keeps its order.

With two locations the line is the first read upward and then the second read downward; a transfer moves the gap between
them, and a block of the table region can be put in at any height (the gap moves there). With one, only on top.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from smash.problem.model import OnGoal

Pile = tuple[str, ...]


def splits(starts: Sequence[Sequence[str]]) -> Iterator[list[Pile]]:
    """Yield the arrangements of the standing blocks that one or two locations can take.

    Args:
        starts: the start pile of each location, bottom first.
    """
    if len(starts) == 1:
        yield [tuple(starts[0])]
        return
    line = (*starts[0], *reversed(starts[1]))
    for gap in range(len(line) + 1):
        yield [line[:gap], line[gap:][::-1]]


def tower_ends(goal: OnGoal, piles: Sequence[Pile]) -> list[Pile] | None:
    """Return what one or two piles become where blocks of the table region make every tower whole, or None.

    Args:
        goal: one whose `ontable` blocks are all in `bottom` or stay in the table region.
        piles: the standing blocks of each location, bottom first, as they will stand at the end.
    """
    ends = _Ends(goal, piles)
    towers = [*goal.towers(), *((block,) for block in goal.clear if block not in goal.on)]
    seen: set[str] = set()
    for tower in towers:
        if tower[0] in seen:
            continue  # a clear block that is a tower already
        seen.update(tower)
        if not ends.take(tower):
            return None
    return ends.finished()


@dataclass(slots=True)
class _Ends:
    """The piles while towers are made whole, and what is said of their bottoms and tops."""

    goal: OnGoal
    piles: Sequence[Pile]
    place: dict[str, tuple[int, int]] = field(default_factory=dict)
    whole: list[dict[int, tuple[Pile, int]]] = field(default_factory=list)
    """Per pile, by the level of its lowest standing block: a tower, and how many of its blocks stand."""
    grounded: dict[int, Pile] = field(default_factory=dict)
    """Per pile, the tower that must stand at its bottom."""
    topped: dict[int, Pile] = field(default_factory=dict)
    """Per pile, the tower on which nothing may come."""
    waiting: list[Pile] = field(default_factory=list)
    """Towers of which nothing stands."""

    def __post_init__(self) -> None:
        self.place = {block: (n, level) for n, pile in enumerate(self.piles) for level, block in enumerate(pile)}
        self.whole = [{} for _ in self.piles]

    def take(self, tower: Pile) -> bool:
        """Take up a tower; whether the blocks of it that stand may do so."""
        standing = [self.place[block] for block in tower if block in self.place]
        grounded, shut = tower[0] in self.goal.bottom, tower[-1] in self.goal.clear
        if not standing:
            if grounded or len(tower) > 1:
                self.waiting.append(tower)
            return True
        if any(upper != (lower[0], lower[1] + 1) for lower, upper in itertools.pairwise(standing)):
            return False
        (number, level), (_, highest) = standing[0], standing[-1]
        top = len(self.piles[number]) - 1
        if (grounded and level > 0) or (shut and highest < top):
            return False
        begun = len(self.piles) == 1 and len(standing) < len(tower)
        if begun and (highest < top or any(block not in self.place for block in tower[: len(standing)])):
            return False  # what is to be put comes on top
        self.whole[number][level] = (tower, len(standing))
        if grounded:
            self.grounded[number] = tower
        if shut:
            self.topped[number] = tower
        return True

    def finished(self) -> list[Pile] | None:
        """Return the piles with every tower whole and those that waited put in, or None where they do not fit."""
        ends = [self._with_towers(number) for number in range(len(self.piles))]
        bottom, clear = frozenset(self.goal.bottom), frozenset(self.goal.clear)
        empty = [number for number, pile in enumerate(self.piles) if not pile]
        for tower in (t for t in self.waiting if t[0] in bottom and t[-1] in clear):
            if not empty:
                return None
            number = empty.pop(0)
            self.grounded[number] = self.topped[number] = ends[number] = tower
        for tower in (t for t in self.waiting if t[0] in bottom and t[-1] not in clear):
            free = [n for n in range(len(ends)) if n not in self.grounded and (len(ends) > 1 or not ends[n])]
            if not free:
                return None
            number = min(free, key=lambda n: n in self.topped)
            self.grounded[number], ends[number] = tower, (*tower, *ends[number])
        for tower in (t for t in self.waiting if t[0] not in bottom and t[-1] in clear):
            free = [n for n in range(len(ends)) if n not in self.topped]
            if not free:
                return None
            self.topped[free[0]] = tower
            ends[free[0]] = (*ends[free[0]], *tower)
        return self._with_others([t for t in self.waiting if t[0] not in bottom and t[-1] not in clear], ends)

    def _with_others(self, others: Sequence[Pile], ends: list[Pile]) -> list[Pile] | None:
        """Put in the towers that stand anywhere: under what is topped, above what is grounded."""
        if not others:
            return ends
        for number, end in enumerate(ends):
            topped = self.topped.get(number)
            if topped is None:
                level = len(end)
            elif topped is self.grounded.get(number) or (len(ends) == 1 and topped not in self.waiting):
                continue
            else:
                level = len(end) - len(topped)
            ends[number] = (*end[:level], *itertools.chain(*others), *end[level:])
            return ends
        return None

    def _with_towers(self, number: int) -> Pile:
        """Return a pile with the missing blocks of its towers put in."""
        end: list[str] = []
        level, pile = 0, self.piles[number]
        while level < len(pile):
            tower, standing = self.whole[number].get(level, (pile[level : level + 1], 1))
            end += tower
            level += standing
        return tuple(end)
