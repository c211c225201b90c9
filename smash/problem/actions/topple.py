"""Topple: one push brings the upper part of a stack down into the table region (paper, definition "Topple")."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from smash.problem.actions.kind import AggregatingKind, Hop
from smash.problem.model import TABLE, Aggregating, Instance, PlanOptions, State


@dataclass(frozen=True, slots=True)
class Topple(Aggregating):
    """Push every block at `height` and above of `location` into the table region, in one action."""

    location: str
    height: int

    def __str__(self) -> str:
        return f"topple {self.location!r} from height {self.height}"


class ToppleKind(AggregatingKind[Topple]):
    """Gathers the top blocks of a stack of `stacks`, leaves them in the table region at unknown poses."""

    name = "topple"
    action = Topple
    form = '["topple", location, height]'
    grounded = False

    def available(self, instance: Instance) -> bool:
        """Every instance has it."""
        return True

    def refusal(self, instance: Instance, options: PlanOptions, state: State, action: Topple) -> str | None:
        """Return why the topple is illegal, or None."""
        pile = state.piles.get(action.location)
        if pile is None:
            return f"no location is called {action.location!r}"
        if action.location not in instance.stacks:
            return "buffers are not toppled"
        if not 1 <= action.height <= len(pile):
            return f"no block falls: the location holds {len(pile)}, heights count from 1"
        falling = len(pile) - action.height + 1
        cap = options.max_topple
        return None if cap is None or falling <= cap else f"{falling} blocks fall, max_topple is {cap}"

    def apply(self, state: State, action: Topple) -> None:
        """Move the falling blocks to the table region."""
        pile = state.piles[action.location]
        state.table.update(pile[action.height - 1 :])
        del pile[action.height - 1 :]

    def legal(self, instance: Instance, options: PlanOptions, state: State) -> Iterator[Topple]:
        """Yield a topple for each stack and cut."""
        for location in instance.stacks:
            height = len(state.piles[location])
            lowest = 1 if options.max_topple is None else max(1, height - options.max_topple + 1)
            yield from (Topple(location, cut) for cut in range(lowest, height + 1))

    def gathered(self, state: State, action: Topple) -> tuple[str, ...]:
        """Return the blocks that fall, topmost first."""
        return tuple(reversed(state.piles[action.location][action.height - 1 :]))

    def hops(self, instance: Instance, options: PlanOptions) -> Iterator[Hop]:
        """Yield the way from each stack to the table region."""
        blocks = len(instance.blocks)
        most = max(1, blocks if options.max_topple is None else min(blocks, options.max_topple))
        yield from (Hop(stack, TABLE, instance.costs.of(self.name), most) for stack in instance.stacks)

    def read(self, entry: list[Any]) -> Topple | None:
        """Return the topple of `["topple", location, height]`."""
        match entry:
            case [_, str(location), int(height)] if not isinstance(height, bool):
                return Topple(location, height)
        return None

    def write(self, action: Topple) -> list[str | int]:
        """Return `["topple", location, height]`."""
        return [self.name, action.location, action.height]
