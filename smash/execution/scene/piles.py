"""What a plan asks of the places: how high piles get, how many blocks fall at once, as the law carries it out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smash.execution.scene.tabletop import WAY_OUT, Tabletop
from smash.problem.actions.registry import kind_of
from smash.problem.actions.topple import Topple
from smash.problem.model import Action, Instance, PositionsGoal, StacksGoal
from smash.problem.rules import Law


def standing_piles(law: Law, actions: Sequence[Action]) -> dict[str, list[tuple[str, ...]]]:
    """Return the piles that stand at each location while a legal plan is carried out, each once, in their order."""
    piles: dict[str, dict[tuple[str, ...], None]] = {}
    for state in law.states(actions):
        for location, pile in state.piles.items():
            if pile:
                piles.setdefault(location, {})[tuple(pile)] = None
    return {location: list(seen) for location, seen in piles.items()}


def highest_piles(law: Law, actions: Sequence[Action]) -> dict[str, int]:
    """Return how many blocks stand at each location at most while a legal plan is carried out, where any do."""
    return {location: max(map(len, piles)) for location, piles in standing_piles(law, actions).items()}


def stations_used(law: Law, actions: Sequence[Action]) -> set[str]:
    """Return the stations that a carrier stands at while a legal plan is carried out."""
    return {station for state in law.states(actions) for station in state.stations.values()}


def largest_topples(law: Law, actions: Sequence[Action]) -> dict[str, int]:
    """Return the most blocks that a legal plan topples at once, for each location that it topples at."""
    most: dict[str, int] = {}
    for state, action in zip(law.states(actions), actions, strict=False):
        if isinstance(action, Topple):
            falling = len(kind_of(action).gathered(state, action))
            most[action.location] = max(most.get(action.location, 0), falling)
    return most


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


def misfits(tabletop: Tabletop, law: Law, actions: Sequence[Action]) -> Iterator[str]:
    """Yield, in words, what of a legal plan a scene that has a slot for every location has no room for."""
    slots = tabletop.bind(law.instance)
    standing = standing_piles(law, actions)
    for location, slot in slots.items():
        piles = standing.get(location, [])
        if not all(tabletop.has_room(slot, pile) for pile in piles):
            piled = f"the plan piles {max(map(len, piles))} blocks on {location!r}"
            yield f"{piled}; scene {tabletop.name!r} has room for {tabletop.room(slot)} there{WAY_OUT}"
    for location in largest_topples(law, actions):
        if not slots[location].directions:
            yield f"the plan topples at {location!r}; scene {tabletop.name!r} has no landing strip there{WAY_OUT}"
