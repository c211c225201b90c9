"""A plan in the making: the law carries out each action as it is added, so that nobody else says what it does."""

from __future__ import annotations

from smash.problem.actions.topple import Topple
from smash.problem.model import TABLE, Action, Pick, Place, State
from smash.problem.problem import Problem


class Draft:
    """The actions so far and the state after them.

    Attributes:
        state: the state, for looking at.
    """

    def __init__(self, problem: Problem) -> None:
        """Begin at the start."""
        self._law = problem.law
        self.state = State.start_of(problem.instance)
        self._actions: list[Action] = []

    @property
    def actions(self) -> tuple[Action, ...]:
        """The plan."""
        return tuple(self._actions)

    def add(self, *actions: Action) -> None:
        """Add actions; a topple of which nothing would fall is left out, for the plan is cheaper without it.

        Raises:
            IllegalAction: where the law refuses one.
        """
        for action in actions:
            if isinstance(action, Topple) and action.height > len(self.state.piles[action.location]):
                continue
            self._law.apply(self.state, action)
            self._actions.append(action)

    def move(self, block: str, source: str, target: str) -> None:
        """Add the pick of a block and its place.

        Raises:
            IllegalAction: where the law refuses one.
        """
        self.add(Pick(block, source), Place(block, target))

    def place_of(self, block: str) -> str:
        """Return the location that a block stands at; the table region where it stands at none."""
        return next((at for at, pile in self.state.piles.items() if block in pile), TABLE)
