"""An instance with numbers in place of names: what the planners that walk through states work on."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from smash.problem.actions.topple import Topple
from smash.problem.model import TABLE, Action, Instance, Pick, Place

ON_TABLE = -1
"""The source of a move from the table region."""
TOPPLE = -1
"""The first entry of a topple step."""

Step = tuple[int, int, int]
"""A transfer `(block, source, target)`, or a topple `(TOPPLE, location, falling)`: how many blocks fall."""


@dataclass(frozen=True, slots=True)
class Numbered:
    """Blocks and locations by number; locations `0 .. stacks-1` are stacks, the rest are buffers.

    `start[q]` is the pile of location q, bottom first; `table` are the blocks in the table region.
    """

    instance: Instance
    stacks: int
    start: tuple[tuple[int, ...], ...]
    table: tuple[int, ...]
    block_number: dict[str, int]

    @classmethod
    def of(cls, instance: Instance) -> Numbered:
        """Number the blocks and locations of `instance` in their order."""
        blocks = {block: number for number, block in enumerate(instance.blocks)}
        return cls(
            instance=instance,
            stacks=len(instance.stacks),
            start=tuple(tuple(blocks[b] for b in instance.start.get(q, ())) for q in instance.locations),
            table=tuple(blocks[b] for b in instance.table),
            block_number=blocks,
        )

    @property
    def blocks(self) -> int:
        """The number of blocks."""
        return len(self.block_number)

    @property
    def locations(self) -> int:
        """The number of locations."""
        return len(self.start)

    def actions(self, steps: Iterable[Step]) -> tuple[Action, ...]:
        """Return steps as actions of the law: a transfer is a pick and a place."""
        blocks, locations = self.instance.blocks, self.instance.locations
        heights = [len(pile) for pile in self.start]
        actions: list[Action] = []
        for first, second, third in steps:
            if first == TOPPLE:
                heights[second] -= third
                actions.append(Topple(locations[second], heights[second] + 1))
                continue
            source = TABLE if second == ON_TABLE else locations[second]
            if second != ON_TABLE:
                heights[second] -= 1
            heights[third] += 1
            actions.append(Pick(blocks[first], source))
            actions.append(Place(blocks[first], locations[third]))
        return tuple(actions)


def cost_of(steps: Iterable[Step]) -> int:
    """Return the cost of steps: 2 a transfer (pick and place), 1 a topple."""
    return sum(1 if step[0] == TOPPLE else 2 for step in steps)
