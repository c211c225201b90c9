"""Lift in the family's domains: a chain of steps down to the lowest lifted block, whose landing pays."""

from __future__ import annotations

from collections.abc import Iterator

from smash.problem.actions.lift import Lift
from smash.problem.model import Action, State
from smash_baselines.names import Fact, Step
from smash_baselines.parts.hand import landing
from smash_baselines.parts.part import Part, Telling


class LiftPart(Part):
    """`lift-begin`, `lift-down`, `lift-off`, `lift-onto`, `lift-end`."""

    kind = "lift"
    blocks_only_hinder = True

    def start(self, telling: Telling) -> Iterator[Fact]:
        """Yield the capacity."""
        yield ("grip", self._levels(telling)[0])

    def costs(self, telling: Telling) -> Iterator[tuple[Fact, int]]:
        """Yield what a lift costs over each way."""
        lift = telling.instance.costs.of(self.kind)
        yield from ((("lift-cost", origin, target), lift + way) for origin, target, way in telling.layout.ways())

    def tells(self, telling: Telling, action: Action) -> bool:
        """Return whether it is a lift."""
        return isinstance(action, Lift)

    def steps(self, telling: Telling, state: State, action: Action) -> Iterator[Step]:
        """Yield the chain from the top of the source to the top of the target."""
        assert isinstance(action, Lift)
        layout, levels = telling.layout, self._levels(telling)
        pile = [telling.block(block) for block in state.piles[action.source]]
        region, spot = layout.region(action.source), layout.spot(action.source)
        target, landed = layout.spot(action.target), layout.region(action.target)
        lowest, further = pile[action.height - 1], len(pile) - action.height
        yield ("lift-begin", pile[-1], region, levels[0])
        for down in range(further):
            yield ("lift-down", pile[-1 - down], pile[-2 - down], region, levels[down], levels[down + 1])
        base, other, onto = telling.base(action.source), telling.base(action.target), state.piles[action.target]
        free, there = len(layout.free(state, region)), len(layout.free(state, landed))
        if action.height > 1:
            yield ("lift-off", lowest, pile[action.height - 2], region, spot, levels[further])
        elif base is not None:
            yield ("lift-off-base", lowest, base, region, spot, levels[further])
        else:
            there += region == landed
            counts = (layout.count(free), layout.count(free + 1))
            yield ("lift-off-buffer", lowest, region, spot, levels[further], *counts)
        if onto:
            yield ("lift-onto", lowest, telling.block(onto[-1]), landed, spot, target)
        elif other is not None:
            yield ("lift-onto-base", lowest, other, landed, spot, target)
        else:
            yield ("lift-onto-buffer", lowest, landed, spot, target, layout.count(there), layout.count(there - 1))
        yield ("lift-end", pile[-1], landed)

    def action(self, telling: Telling, state: State, step: Step) -> Action | None:
        """Return the lift when it has landed; one that lands where it was changes nothing."""
        if not step[0].startswith("lift-onto"):
            return None
        source, height = telling.where(state, step[1])
        try:
            target = landing(telling, state, step)
        except StopIteration:  # the only empty buffer is the one that the lift has left
            return None
        return None if source == target else Lift(source, height, target)

    def _levels(self, telling: Telling) -> list[str]:
        """Return the counts that the grip goes down by, from the blocks that may be lifted beside the top one."""
        most = min(telling.instance.capacities[self.kind], max(1, len(telling.instance.blocks)))
        return [telling.layout.count(left) for left in range(most - 1, -1, -1)]
