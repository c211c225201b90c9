"""From moves between kinds of places to steps between locations."""

from __future__ import annotations

from smash.planners.astar.task import TOPPLED
from smash.problem.views.numbered import ON_TABLE, TOPPLE, Numbered, Step


class Walk:
    """Carries out the search's moves on the locations by number, choosing the first free one of a class."""

    def __init__(self, problem: Numbered, class_of: list[int]) -> None:
        self.steps: list[Step] = []
        self._blocks = problem.blocks
        self._class_of = class_of
        self._piles = [list(pile) for pile in problem.start]
        self._at = dict.fromkeys(problem.table, ON_TABLE)
        for location, pile in enumerate(self._piles):
            self._at.update(dict.fromkeys(pile, location))

    def move(self, block: int, code: int) -> None:
        """Make a move: topple from `block` up, or put it on the block or the kind of floor that `code` says."""
        source = self._at[block]
        if code == TOPPLED:
            pile = self._piles[source]
            level = pile.index(block)
            self.steps.append((TOPPLE, source, len(pile) - level))
            self._at.update(dict.fromkeys(pile[level:], ON_TABLE))
            del pile[level:]
            return
        target = self._at[code] if code < self._blocks else self._free(code - self._blocks)
        self.steps.append((block, source, target))
        if source != ON_TABLE:
            self._piles[source].pop()
        self._piles[target].append(block)
        self._at[block] = target

    def _free(self, number: int) -> int:
        return next(q for q, kind in enumerate(self._class_of) if kind == number and not self._piles[q])
