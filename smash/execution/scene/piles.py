"""What a plan asks of the places: how high piles get, how many blocks fall at once, as the law carries it out."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from smash.execution.scene.tabletop import WAY_OUT, Tabletop
from smash.problem.actions.registry import kind_of
from smash.problem.actions.topple import Topple
from smash.problem.model import Action, Instance, PositionsGoal, StacksGoal
from smash.problem.rules import Law


@dataclass(frozen=True, slots=True)
class Needs:
    """What a legal plan asks of the places.

    Attributes:
        piles: The piles that stand at each location, each once, in their order; not the locations where none does.
        topples: The most blocks that are toppled at once, for each location that is toppled at.
        stations: Where a carrier stands at some time, each once.
    """

    piles: Mapping[str, Collection[tuple[str, ...]]]
    topples: Mapping[str, int]
    stations: tuple[str, ...]

    @property
    def highest(self) -> dict[str, int]:
        """How many blocks stand at each location at most, where any do."""
        return {location: max(map(len, piles)) for location, piles in self.piles.items()}


def needs_of(law: Law, actions: Sequence[Action]) -> Needs:
    """Return what a plan asks of the places, as the law carries it out.

    Raises:
        IllegalAction: at the first action that the law refuses.
    """
    piles: dict[str, dict[tuple[str, ...], None]] = {}
    topples: dict[str, int] = {}
    stations: dict[str, None] = {}
    for state, action in zip_longest(law.states(actions), actions):
        stations.update(dict.fromkeys(state.stations.values()))
        for location, pile in state.piles.items():
            if pile:
                piles.setdefault(location, {})[tuple(pile)] = None
        if isinstance(action, Topple):
            falling = len(kind_of(action).gathered(state, action))
            topples[action.location] = max(topples.get(action.location, 0), falling)
    return Needs(piles, topples, tuple(stations))


def piles_of_ends(instance: Instance) -> dict[str, int]:
    """Return the most blocks that each location holds at the start or, as far as the goal says so, at the end."""
    ended = {}
    match instance.goal:
        case StacksGoal(stacks):
            ended = {location: len(pile) for location, pile in stacks.items()}
        case PositionsGoal(positions):
            for location, height in positions.values():
                ended[location] = max(ended.get(location, 0), height)
    return {name: max(len(instance.start.get(name, ())), ended.get(name, 0)) for name in instance.locations}


def misfits(tabletop: Tabletop, instance: Instance, needs: Needs) -> Iterator[str]:
    """Yield, in words, what of a legal plan a scene that has a slot for every location has no room for.

    Args:
        tabletop: The scene.
        instance: What the plan is for.
        needs: What it asks.
    """
    slots = tabletop.bind(instance)
    for location, slot in slots.items():
        piles = needs.piles.get(location, ())
        if not all(tabletop.has_room(slot, pile) for pile in piles):
            piled = f"the plan piles {max(map(len, piles))} blocks on {location!r}"
            yield f"{piled}; scene {tabletop.name!r} has room for {tabletop.room(slot)} there{WAY_OUT}"
    for location in needs.topples:
        if not slots[location].directions:
            yield f"the plan topples at {location!r}; scene {tabletop.name!r} has no landing strip there{WAY_OUT}"
