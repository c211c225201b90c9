"""Pick and place in the family's domains: the part that all of them have."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise

from smash.problem.model import TABLE, Action, Instance, Pick, Place, PlanOptions, State
from smash_baselines.names import Fact, Step
from smash_baselines.parts.part import Part, Telling


class HandPart(Part):
    """Blocks one by one between piles, and out of the table region."""

    kind = "pick-and-place"
    blocks_only_hinder = True

    def needed(self, instance: Instance, options: PlanOptions) -> bool:
        """Every domain has it."""
        return True

    def objects(self, telling: Telling) -> Mapping[str, tuple[str, ...]]:
        """Return blocks, stack locations, regions, spots and counts."""
        layout = telling.layout
        return {
            "block": tuple(layout.names.blocks.values()),
            "location": tuple(layout.names.locations.values()),
            "region": tuple(layout.regions.values()),
            "spot": tuple(layout.spots.values()),
            "count": layout.counts,
        }

    def start(self, telling: Telling) -> Iterator[Fact]:
        """Yield the piles, the table region, and where everything is."""
        layout, instance = telling.layout, telling.instance
        held = instance.hand
        yield ("hand-empty",) if held is None else ("holding", telling.block(held), layout.origin(None))
        yield ("idle",)
        for location in instance.locations:
            yield from _pile(telling, location)
        yield from (("on-table", telling.block(block)) for block in instance.table)
        yield from (("wanted", telling.block(block)) for block in instance.blocks if block in telling.wanted)
        yield from (("in", short, layout.region(location)) for location, short in layout.names.locations.items())
        start = State.start_of(instance)
        for (is_stack, spot), region in layout.regions.items():
            yield ("stands", region, spot)
            if not is_stack:
                yield ("free", region, layout.count(len(layout.free(start, region))))
        yield ("table-at", layout.spot(TABLE))
        yield from (("next", less, more) for less, more in pairwise(layout.counts))

    def costs(self, telling: Telling) -> Iterator[tuple[Fact, int]]:
        """Yield what a pick costs, and a place over each way."""
        costs = telling.instance.costs
        yield ("pick-cost",), costs.of("pick")
        for origin, target, way in telling.layout.ways():
            yield ("place-cost", origin, target), costs.of("place") + way

    def tells(self, telling: Telling, action: Action) -> bool:
        """Picks and places, but for those of carriers."""
        match action:
            case Pick(_, place) | Place(_, place):
                return place == TABLE or place in telling.instance.locations
        return False

    def steps(self, telling: Telling, state: State, action: Action) -> Iterator[Step]:
        """Yield the one step of a pick or a place."""
        match action:
            case Pick(block, source):
                yield _pick(telling, state, block, source)
            case Place(block, target):
                yield _place(telling, state, block, target)

    def action(self, telling: Telling, state: State, step: Step) -> Action | None:
        """Return the pick or place."""
        name, block = step[0], telling.named(step[1])
        match name:
            case "pick-from-table":
                return Pick(block, TABLE)
            case "pick" | "pick-base" | "pick-from-buffer":
                return Pick(block, telling.where(state, step[1])[0])
        return Place(block, landing(telling, state, step))


def landing(telling: Telling, state: State, step: Step) -> str:
    """Return the location that a step puts blocks on: `NAME ?b ?under …`, `NAME-base ?b ?l …`, `…-buffer ?b ?r …`.

    Raises:
        StopIteration: where no buffer of the region is empty.
    """
    if step[0].endswith("-base"):
        return telling.layout.names.location_of[step[2]]
    if step[0].endswith("-buffer"):
        return next(iter(telling.layout.free(state, step[2])))
    return telling.where(state, step[2])[0]


def _pile(telling: Telling, location: str) -> Iterator[Fact]:
    pile = [telling.block(block) for block in telling.instance.start.get(location, ())]
    base, region = telling.base(location), telling.layout.region(location)
    if not pile:
        if base is not None:
            yield ("empty", base)
        return
    yield ("on-buffer", pile[0], region) if base is None else ("base", pile[0], base)
    yield ("bottom", pile[0])
    yield from (("on", upper, under) for under, upper in pairwise(pile))
    yield ("top", pile[-1], region)


def _pick(telling: Telling, state: State, block: str, source: str) -> Step:
    layout = telling.layout
    spot, short = layout.spot(source), telling.block(block)
    if source == TABLE:
        return ("pick-from-table", short, spot)
    base, region, pile = telling.base(source), layout.region(source), state.piles[source]
    if len(pile) > 1:
        return ("pick", short, telling.block(pile[-2]), region, spot)
    if base is not None:
        return ("pick-base", short, base, region, spot)
    free = len(layout.free(state, region))
    return ("pick-from-buffer", short, region, spot, layout.count(free), layout.count(free + 1))


def _place(telling: Telling, state: State, block: str, target: str) -> Step:
    layout = telling.layout
    base, region, pile, short = telling.base(target), layout.region(target), state.piles[target], telling.block(block)
    way = (layout.origin(state.origin), layout.spot(target))
    if pile:
        return ("place", short, telling.block(pile[-1]), region, *way)
    if base is not None:
        return ("place-base", short, base, region, *way)
    free = len(layout.free(state, region))
    return ("place-on-buffer", short, region, *way, layout.count(free), layout.count(free - 1))
