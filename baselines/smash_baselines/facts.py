"""An instance as PDDL facts: objects, initial facts and goal facts of one encoding."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

from smash.problem.model import Instance, OnGoal, PlanOptions, PositionsGoal, StacksGoal, no_goal
from smash_baselines.encodings import Encoding, cap_of
from smash_baselines.goal_words import ended, word_facts, word_names
from smash_baselines.names import Fact, Names, count_names
from smash_baselines.parts.layout import Layout
from smash_baselines.parts.part import Telling


@dataclass(frozen=True, slots=True)
class Facts:
    """A PDDL problem without its syntax: objects by type, what holds at the start, what must hold at the end.

    `costs` are the values of cost functions.
    """

    objects: dict[str, tuple[str, ...]]
    start: tuple[Fact, ...]
    goal: tuple[Fact, ...]
    costs: tuple[tuple[Fact, int], ...] = ()


def trim_buffers(instance: Instance) -> Instance:
    """Return an equivalent instance without the buffers that no plan can need.

    Never more piles than blocks stand at once, so the buffers used at the start and as many more as there are
    blocks in all suffice; the others only make planners slow. Where travel costs, this holds for the buffers
    of one position each.
    """
    kept: set[str] = set()
    for group in _alike(instance):
        used = [buffer for buffer in group if instance.start.get(buffer)]
        spare = [buffer for buffer in group if not instance.start.get(buffer)]
        kept.update(used, spare[: max(0, len(instance.blocks) - len(used))])
    buffers = tuple(buffer for buffer in instance.buffers if buffer in kept)
    start = {location: instance.start.get(location, ()) for location in instance.stacks + buffers}
    costs = instance.costs
    dropped = set(instance.buffers) - kept
    if dropped:
        places = {place: point for place, point in costs.positions.items() if place not in dropped}
        costs = replace(costs, positions=places)
    return replace(instance, buffers=buffers, start=start, costs=costs)


def _alike(instance: Instance) -> list[list[str]]:
    """Return the buffers in groups that no plan's cost tells apart."""
    groups: dict[object, list[str]] = {}
    for buffer in instance.buffers:
        key = instance.costs.positions[buffer] if instance.costs.travel else None
        groups.setdefault(key, []).append(buffer)
    return list(groups.values())


def named_blocks(instance: Instance) -> frozenset[str]:
    """Return the blocks that the goal names: no cheapest plan picks another one from the table region.

    Leave such a pick and what follows for this block out: every pile that it stood in is one lower, everything else
    is as before, and at the end nothing rests on it that the goal wants at a height or on something else. This holds
    for actions that blocks only hinder (`Part.blocks_only_hinder`). What `ontable` and `clear` ask of the block itself
    holds in the table region too.

    Args:
        instance: with the goal that PDDL is told (`smash_baselines.goal_words.told`): an `ontable` block that carries
            another is in `bottom`.
    """
    match instance.goal:
        case StacksGoal():
            return frozenset(instance.blocks)
        case PositionsGoal(positions):
            return frozenset(positions)
        case OnGoal(on, bottom):
            return frozenset((*on, *on.values(), *bottom))
        case _:
            no_goal(instance.goal)


def facts_of(
    instance: Instance, options: PlanOptions, encoding: Encoding, names: Names, wanted: Collection[str] | None = None
) -> Facts:
    """Return the facts of an instance in one encoding.

    Args:
        instance: the problem.
        options: what a plan may use.
        encoding: the domain.
        names: how its objects are called.
        wanted: the blocks that may be picked from the table region, in the family's domains; all, where None or
            where an action of the domain may need the others.
    """
    if encoding.parts:
        if wanted is None or not all(part.blocks_only_hinder for part in encoding.parts):
            wanted = instance.blocks
        return _family_facts(Telling(instance, options, Layout(instance, names), wanted), encoding)
    cap = cap_of(instance, options) if encoding.capped else None
    counts = count_names(max(len(instance.buffers), 0 if cap is None else cap - 1))
    start: list[Fact] = [_hand(instance, names)]
    if encoding.chain:
        start.append(("idle",))
    start += _piles(instance, encoding, names)
    start += [("on-table", names.blocks[block]) for block in instance.table]
    free = sum(not instance.start.get(buffer) for buffer in instance.buffers)
    start.append(("free-buffers", counts[free]))
    if cap is not None:
        start.append(("cap", counts[cap - 1]))
    start += [("next", counts[k], counts[k + 1]) for k in range(len(counts) - 1)]
    start += word_facts(instance.goal, names)
    objects = {
        "block": tuple(names.blocks.values()),
        "location": tuple(names.locations.values()),
        "count": tuple(counts),
        "word": word_names(instance.goal),
    }
    idle: tuple[Fact, ...] = (("idle",),) if encoding.chain else ()
    return Facts(objects, tuple(start), (*_goal(instance, names), *ended(instance.goal), *idle))


def _hand(instance: Instance, names: Names) -> Fact:
    return ("hand-empty",) if instance.hand is None else ("holding", names.blocks[instance.hand])


def _family_facts(telling: Telling, encoding: Encoding) -> Facts:
    objects: dict[str, tuple[str, ...]] = {}
    for part in encoding.parts:
        objects |= part.objects(telling)
    goal, names = telling.instance.goal, telling.layout.names
    start = [fact for part in encoding.parts for fact in part.start(telling)]
    return Facts(
        objects | {"word": word_names(goal)},
        (*start, *word_facts(goal, names)),
        (*_goal(telling.instance, names), *ended(goal), ("idle",)),
        tuple(cost for part in encoding.parts for cost in part.costs(telling)),
    )


def _piles(instance: Instance, encoding: Encoding, names: Names) -> Iterator[Fact]:
    for location in instance.locations:
        pile = [names.blocks[block] for block in instance.start.get(location, ())]
        stack = names.locations.get(location)
        if not pile:
            if stack is not None:
                yield ("empty", stack)
            continue
        yield ("on-buffer", pile[0]) if stack is None else ("base", pile[0], stack)
        yield ("bottom", pile[0])
        yield from (("on", upper, under) for under, upper in pairwise(pile))
        region = "buffers" if stack is None else "stacks"
        yield ("top", pile[-1], region) if encoding.chain else ("top", pile[-1])
        if encoding.closure:
            yield from (("stacked", block) for block in pile)
            yield from (("above", pile[i], pile[j]) for i in range(len(pile)) for j in range(i))
            if stack is not None:
                yield from (("above", block, "stacks") for block in pile)


def _goal(instance: Instance, names: Names) -> Iterator[Fact]:
    """Yield what the goal asks for; with every block placed, empty locations and table follow of themselves."""
    match instance.goal:
        case StacksGoal(piles):
            yield from _goal_piles(piles, names)
        case PositionsGoal() as goal:
            yield from _goal_piles(goal.stacks(), names)
        case OnGoal(on, bottom):
            yield from (("on", names.blocks[upper], names.blocks[under]) for upper, under in on.items())
            yield from (("bottom", names.blocks[block]) for block in bottom)
        case _:
            no_goal(instance.goal)


def _goal_piles(piles: Mapping[str, tuple[str, ...]], names: Names) -> Iterator[Fact]:
    for location, pile in piles.items():
        if pile:
            yield ("base", names.blocks[pile[0]], names.locations[location])
        yield from (("on", names.blocks[upper], names.blocks[under]) for under, upper in pairwise(pile))
