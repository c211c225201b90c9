"""What a goal asks of the blocks: who must leave, who must be placed where, in which order (`docs/theory.md`).

The three goal kinds come down to one form. Every location has a part that may stay and a part that must
leave; every goal tower has a lower part that stands already and a chain of blocks above it that each
need a final placement, from the bottom to the top.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from smash.problem.model import Instance, OnGoal, PositionsGoal, StacksGoal

Pile = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FloatingChain:
    """Blocks to be piled up at no particular location; `bottom`: the lowest at the bottom of one."""

    blocks: Pile
    bottom: bool


@dataclass(frozen=True, slots=True)
class Demands:
    """The demands of a goal on the start of an instance.

    Attributes:
        keep: per location, how many of its lowest blocks need not move.
        leaving: per location, the blocks above those, bottom first; each of them leaves in every plan.
        build: per location, the blocks that are to be placed on the kept ones, bottom first.
        floating: chains of an `on` goal whose location is free.
        placed: every block of `build` and `floating`; each needs a placement that is its last.
        loose: the leaving blocks that the goal gives no place.
    """

    keep: dict[str, int]
    leaving: dict[str, Pile]
    build: dict[str, Pile]
    floating: tuple[FloatingChain, ...]
    placed: frozenset[str]
    loose: frozenset[str]

    @property
    def met(self) -> bool:
        """Whether nothing is left to do."""
        return not self.placed and not self.loose


def demands_of(
    instance: Instance, most: Mapping[str, int] | None = None, at: Mapping[str, str] | None = None
) -> Demands:
    """Work out what the goal of `instance` asks of its start.

    Args:
        instance: the problem.
        most: of an `on` goal, how many of the lowest blocks of locations are kept at most; None: all that may stay.
        at: of an `on` goal, the locations of towers that are begun anew, by their base; the others may be anywhere.
            Of towers at one location each stands on those before it, all on one that has to be at the bottom.
    """
    goal = instance.goal
    if isinstance(goal, OnGoal):
        return _on_demands(instance, goal, most or {}, at or {})
    return _located_demands(instance, goal)


def _located_demands(instance: Instance, goal: StacksGoal | PositionsGoal) -> Demands:
    wanted = goal.stacks if isinstance(goal, StacksGoal) else goal.stacks()
    keep: dict[str, int] = {}
    build: dict[str, Pile] = {}
    listed = {block for pile in wanted.values() for block in pile}
    for location in instance.locations:
        standing, pile = instance.start[location], tuple(wanted.get(location, ()))
        common = 0
        while common < min(len(standing), len(pile)) and standing[common] == pile[common]:
            common += 1
        if pile[common:]:
            build[location] = pile[common:]
            keep[location] = common
        else:  # complete: what the goal does not name may stay on it, up to the lowest block wanted elsewhere
            heights = (height for height in range(common, len(standing)) if standing[height] in listed)
            keep[location] = next(heights, len(standing))
    return _demands(instance, keep, build, ())


def _on_demands(instance: Instance, goal: OnGoal, most: Mapping[str, int], at: Mapping[str, str]) -> Demands:
    above = {under: upper for upper, under in goal.on.items()}
    bottom, clear = frozenset(goal.bottom), frozenset(goal.clear)
    grounded = bottom.union(goal.ontable)
    keep: dict[str, int] = {}
    stays: dict[str, str] = {}
    for location in instance.locations:
        standing = instance.start[location]
        standing = standing[: most.get(location, len(standing))]
        under: str | None = None
        kept = 0
        for block in standing:
            if goal.on.get(block, under) != under or (under is not None and block in grounded):
                break
            if under is not None and (under in clear or above.get(under, block) != block):
                break
            stays[block] = location
            under = block
            kept += 1
        keep[location] = kept
    build: dict[str, Pile] = {}
    floating: list[FloatingChain] = []
    for tower in goal.towers():
        standing_part = sum(block in stays for block in tower)
        rest = tower[standing_part:]
        if rest and standing_part:
            build[stays[tower[standing_part - 1]]] = rest
        elif rest:
            floating.append(FloatingChain(rest, tower[0] in bottom))
    # What is begun at a location stands on what is built on its kept part, and a bottom comes first.
    order = {base: number for number, base in enumerate(at)}
    begun = [chain for chain in floating if chain.blocks[0] in order]
    for chain in sorted(begun, key=lambda chain: (not chain.bottom, order[chain.blocks[0]])):
        location = at[chain.blocks[0]]
        build[location] = build.get(location, ()) + chain.blocks
    floating = [chain for chain in floating if chain.blocks[0] not in order]
    return _demands(instance, keep, build, tuple(floating))


def _demands(
    instance: Instance, keep: dict[str, int], build: dict[str, Pile], floating: tuple[FloatingChain, ...]
) -> Demands:
    leaving = {location: instance.start[location][keep[location] :] for location in instance.locations}
    chains = [*build.values(), *(chain.blocks for chain in floating)]
    placed = frozenset(block for chain in chains for block in chain)
    loose = frozenset(block for pile in leaving.values() for block in pile) - placed
    return Demands(keep, leaving, build, floating, placed, loose)
