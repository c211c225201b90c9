"""The blocks that move, by number, and the edges of each between its nodes: start, places, home.

Sources of a move are the places and, last, the *start* (the location where the block waits until its first removal).
Targets are the locations and decks, then *home* (its goal), then *anywhere*: a block without a goal is forgotten
after its second removal. Lifts and falls have the locations and the start as sources; lifts the locations, home and
anywhere as targets.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from smash.planners.layered.blocks import MovingBlocks
from smash.planners.layered.network.places import NO_EDGE, Places
from smash.planners.milp.arrays import Ints
from smash.problem.model import OnGoal
from smash.problem.problem import Problem


@dataclass(frozen=True, slots=True)
class Moving:
    """The moving blocks among the places.

    Attributes:
        places: the places.
        blocks: the blocks by number, their piles and chains.
        piles: per location, by its number, the blocks that leave it, bottom first.
        origin: per block the location where it waits at the start, -1: it lies or is held.
        target: per block the location of its goal, -1: it has none, or any location serves (`anywhere`).
        anywhere: whether the goal names no locations (an `on` goal).
    """

    places: Places
    blocks: MovingBlocks
    piles: tuple[tuple[int, ...], ...]
    origin: tuple[int, ...]
    target: tuple[int, ...]
    anywhere: bool

    @classmethod
    def of(cls, problem: Problem) -> Moving:
        """Work out where the moving blocks of a problem start and end."""
        places, blocks = Places.of(problem), MovingBlocks.of(problem)
        anywhere = isinstance(problem.instance.goal, OnGoal)
        origin, target = [NO_EDGE] * len(blocks), [NO_EDGE] * len(blocks)
        number = {location: at for at, location in enumerate(places.locations)}
        for location, pile in blocks.piles:
            for block in pile:
                origin[block] = number[location]
        for end, chain in blocks.chains:
            if end is not None and not anywhere:
                for block in chain:
                    target[block] = number[end]
        leaving = dict(blocks.piles)
        return cls(
            places=places,
            blocks=blocks,
            piles=tuple(leaving.get(location, ()) for location in places.locations),
            origin=tuple(origin),
            target=tuple(target),
            anywhere=anywhere,
        )

    @property
    def home(self) -> int:
        """The target of a move home, behind the locations and decks."""
        return self.places.count - 1

    @property
    def gone(self) -> int:
        """The target of a move to anywhere."""
        return self.places.count

    @property
    def start(self) -> int:
        """The source of a move from the start, behind the places."""
        return self.places.count

    def transfers(self) -> Ints:
        """Return (blocks, sources, targets) what each move costs, -1: no such edge."""
        table = np.full((len(self.blocks), self.start + 1, self.gone + 1), NO_EDGE, dtype=np.int64)
        for block, origin in enumerate(self.origin):
            for source in range(self.start + (origin >= 0)):
                prices = self.places.transfer[origin if source == self.start else source]
                if block in self.blocks.placed:
                    table[block, source, : self.home] = prices[: self.home]
                    table[block, source, self.home] = self._home_price(block, prices)
                elif source == self.start:
                    table[block, source, : self.home] = prices[: self.home]
                elif source != self.places.table:  # without a goal there is no reason to leave the table region
                    table[block, source, self.gone] = _cheapest(prices)
        return table

    def _home_price(self, block: int, prices: Ints) -> int:
        return _cheapest(prices[: len(self.places.locations)]) if self.anywhere else int(prices[self.target[block]])

    def falls(self) -> Ints:
        """Return (blocks, locations + start) 0 where a block can fall, -1 elsewhere."""
        table = np.full((len(self.blocks), len(self.places.locations) + 1), NO_EDGE, dtype=np.int64)
        table[:, : self.places.toppled] = 0
        table[[block for block, at in enumerate(self.origin) if 0 <= at < self.places.toppled], -1] = 0
        return table

    def lifts(self) -> Ints:
        """Return (blocks, locations + start, locations + home + anywhere): 0 where a lift moves a block, else -1."""
        locations = len(self.places.locations)
        table = np.full((len(self.blocks), locations + 1, locations + 2), NO_EDGE, dtype=np.int64)
        for block, origin in enumerate(self.origin):
            for source in range(locations + (origin >= 0)):
                at = origin if source == locations else source
                there = self.places.lift[at] >= 0
                if not there.any():
                    continue
                if block in self.blocks.placed or source == locations:
                    table[block, source, :locations] = np.where(there, 0, NO_EDGE)
                if block in self.blocks.placed and at != self.target[block]:
                    table[block, source, locations] = 0
                if block not in self.blocks.placed and source != locations:
                    table[block, source, locations + 1] = 0
        return table


def _cheapest(prices: Ints) -> int:
    there = prices[prices >= 0]
    return int(there.min()) if there.size else NO_EDGE
