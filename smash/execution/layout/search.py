"""Search for a layout: places are put down one by one, those with the longest strips first, each where most is left.

An attempt puts every place on the candidate that leaves the others most candidates, out of a sample, and gives up
where one has none left; the next attempt has another order and other samples, and things come closer together from
third to third of the attempts (`SPACINGS`). What an attempt leaves has then to be accepted by judges that know nothing
of the search. The same arguments give the same layout.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smash.execution.layout.candidates import SPACINGS, Candidates, Spacing, candidates
from smash.execution.layout.hand_room import HandRoom
from smash.execution.layout.rectangles import Mask
from smash.execution.layout.wanted import Place
from smash.execution.scene.tabletop import Slot
from smash.motion.robot import Robot

SAMPLE = 12
"""Candidates that are looked at for each place."""
COUNTED = 400
"""Candidates of the other places by which is judged how much is left."""

Kind = tuple[int, int]
"""Height and falling blocks of a place."""
Judge = Callable[[Sequence[Slot]], str | None]
"""From slots, in the order of the places, to why they are no layout, or None."""


@dataclass(frozen=True, slots=True)
class Found:
    """What a search ended with.

    Attributes:
        slots: A slot for every place, in their order; None where no attempt was accepted.
        attempts: How many there were.
        reason: Why the last attempt that came nearest failed; empty where one succeeded.
    """

    slots: tuple[Slot, ...] | None
    attempts: int
    reason: str = ""


def find_layout(
    places: Sequence[Place], side: float, robot: Robot, judge: Judge, *, attempts: int = 60, seed: int = 0
) -> Found:
    """Look for slots for all places.

    Args:
        places: What is asked for.
        side: Of a block [m].
        robot: Who has to reach them.
        judge: Has the last word on what an attempt leaves.
        attempts: How many there are at most.
        seed: Of the attempts.
    """
    kinds = {(place.height, place.falling): place for place in places}
    pools = {kind: candidates(place, side, robot) for kind, place in kinds.items()}
    room, nearest, reason = HandRoom(side, robot), -1, ""
    for number in range(attempts):
        spacing = SPACINGS[len(SPACINGS) * number // attempts]
        attempt = _Attempt(places, side, pools, room, np.random.default_rng((seed, number)), spacing)
        stuck = attempt.run()
        slots = attempt.slots()
        problem = stuck or judge(slots)
        if problem is None:
            return Found(tuple(slots), number + 1)
        if len(slots) > nearest:
            nearest, reason = len(slots), problem
    return Found(None, attempts, reason)


class _Attempt:
    """One attempt: `run`, then `slots`."""

    def __init__(
        self,
        places: Sequence[Place],
        side: float,
        pools: dict[Kind, Candidates],
        room: HandRoom,
        generator: np.random.Generator,
        spacing: Spacing,
    ) -> None:
        self._places = places
        self._side = side
        self._pools = pools
        self._room = room
        self._generator = generator
        self._spacing = spacing
        self._open: dict[Kind, Mask] = {kind: np.ones(len(pool.slots), dtype=bool) for kind, pool in pools.items()}
        self._placed: dict[int, Slot] = {}

    def slots(self) -> list[Slot]:
        """The slots that were found, in the order of their places."""
        return [self._placed[index] for index in sorted(self._placed)]

    def run(self) -> str | None:
        """Place all; say which place found none, or None."""
        waiting = self._order()
        while waiting:
            index = waiting.pop(0)
            place = self._places[index]
            for chosen in self._promising((place.height, place.falling), waiting):
                slot = chosen.slots[0]
                if self._room.among([*self._placed.values(), slot]):
                    self._put(index, chosen)
                    break
            else:
                done = f"{len(self._placed)} of {len(self._places)} places were found"
                return f"{done}, none for {place.location!r}"
        return None

    def _order(self) -> list[int]:
        """Long strips first, then high piles; at random where they are alike, and a little out of order."""
        noise = self._generator.uniform(0.0, 1.5, len(self._places))
        return sorted(
            range(len(self._places)),
            key=lambda index: (
                self._places[index].falling == 0,
                -min(self._places[index].falling, 5) + noise[index],
                -self._places[index].height,
            ),
        )

    def _promising(self, kind: Kind, waiting: Sequence[int]) -> Iterator[Candidates]:
        """A sample of the candidates of a kind that are left, those first that leave most to the places that wait."""
        pool, left = self._pools[kind], np.flatnonzero(self._open[kind])
        sample = self._generator.permutation(left)[:SAMPLE]
        chosen = [pool.only(int(which)) for which in sample]
        needed: dict[Kind, int] = {}
        for index in waiting:
            other = self._places[index]
            needed[other.height, other.falling] = needed.get((other.height, other.falling), 0) + 1
        counted = {other: self._some(other) for other in needed}
        worth = [
            sum(count * np.log1p(self._left(counted[other], one)) for other, count in needed.items()) for one in chosen
        ]
        for rank in np.argsort(-np.array(worth), kind="stable"):
            yield chosen[rank]

    def _some(self, kind: Kind) -> Candidates:
        left: NDArray[np.int64] = np.flatnonzero(self._open[kind])
        if len(left) > COUNTED:
            left = np.sort(self._generator.choice(left, COUNTED, replace=False))
        return self._pools[kind].some(left)

    def _left(self, others: Candidates, one: Candidates) -> float:
        return float(others.beside(one, self._side, self._spacing).sum())

    def _put(self, index: int, chosen: Candidates) -> None:
        self._placed[index] = chosen.slots[0]
        for kind, pool in self._pools.items():
            left = np.flatnonzero(self._open[kind])
            self._open[kind][left] &= pool.some(left).beside(chosen, self._side, self._spacing)
