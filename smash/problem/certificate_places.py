"""The part of a certificate about `on` goals where locations are few, and its checker: what goes where.

Choices are 0 or 1, named as in `docs/files.md`:

- `removed b`: b leaves its start pile (2 actions, or none where it can fall and the goal gives it no place);
- `at t q`: the base of tower t leaves where it starts and is placed for good on location q;
- `under t u`: towers t and u, neither at a bottom, are begun anew at one location, t below u;
- `topple q low high` (1) and `aside b` (2): what keeps a block from moving directly.

Every plan without idle transfers gives them values that fulfil the rows of `PlacesChecker.row` at no more than its
cost. A leaf's weights w bound the cost of all values that its cases allow: the sum of w times what a row asks for, and
for each choice the least of (cost - load) times its value (Lagrangian relaxation), in whole millionths.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import msgspec

from smash.problem.errors import RefusedCertificate
from smash.problem.model import Instance, OnGoal, PlanOptions

ONE = 1_000_000
"""Weights are whole millionths of an action."""
REMOVED, PLACED = "removed", "placed"
MOVE, TOPPLE, ASIDE = 2, 1, 2
"""Actions of a move, of a topple, and of putting aside beyond the move."""

Key = tuple[str | int, ...]


class NamedLeaf(msgspec.Struct, forbid_unknown_fields=True, tag_field="kind", tag="rows"):
    """A case closed by weights: `[name of the row, millionths]` each."""

    rows: list[tuple[list[str | int], int]]


class NamedCases(msgspec.Struct, forbid_unknown_fields=True, tag_field="kind", tag="cases"):
    """Two cases: a choice is 1 (taken), or it is 0."""

    choice: list[str | int]
    taken: NamedLeaf | NamedCases
    untaken: NamedLeaf | NamedCases


class ConditionalCycle(msgspec.Struct, forbid_unknown_fields=True):
    """Events `[removed | placed, block]`, each before the next and the last before the first, where `given` holds.

    Given are `["removed", b]`, `["stays", b]`, `["at", t, q]` and `["under", t, u]`.
    """

    events: list[tuple[str, str]]
    given: list[list[str]]


class PlacesProof(msgspec.Struct, forbid_unknown_fields=True):
    """Cycles and a tree of cases, in place of those of the plain argument."""

    cycles: list[ConditionalCycle]
    proof: NamedLeaf | NamedCases


class Row(NamedTuple):
    """The sum of sign times choice is at least `least`, or just that where `equal`."""

    least: int
    signs: dict[Key, int]
    equal: bool = False


@dataclass(frozen=True, slots=True)
class _Given:
    """What the conditions of a cycle say: the conditions, and the blocks that leave their start piles."""

    conditions: frozenset[Key]
    leaves: frozenset[str]


class PlacesChecker:
    """Derives from an instance what the choices cost, which rows hold, and whether a conditional cycle is one.

    Args:
        instance: one with an `on` goal as it is posed, where blocks start at locations or in the table region.
        options: whether plans may topple, and how many blocks.

    Attributes:
        base: what every plan costs beyond the choices.
        costs: per choice.

    Raises:
        RefusedCertificate: for another goal.
    """

    def __init__(self, instance: Instance, options: PlanOptions) -> None:
        goal = instance.goal
        if not isinstance(goal, OnGoal):
            raise RefusedCertificate("it chooses places, and the goal is no `on` goal")
        self.piles = {location: instance.start[location] for location in instance.locations}
        self.spot = {b: (q, height) for q, pile in self.piles.items() for height, b in enumerate(pile)}
        self.tower = {b: (tower, rank) for tower in goal.towers() for rank, b in enumerate(tower)}
        wrong = wrong_relations(instance, goal)
        lifted = {b for pile in self.piles.values() for n, b in enumerate(pile) if not wrong.isdisjoint(pile[: n + 1])}
        self.leaves = frozenset(lifted | (set(self.tower) & set(instance.table)))
        moving = [t[0] for t in goal.towers() if t[0] in self.spot or t[0] in self.leaves]
        self.bottoms = [base for base in moving if base in goal.bottom]
        self.loose = [base for base in moving if base not in goal.bottom]
        self.base = MOVE * len(set(self.tower) & set(instance.table))
        self.costs: dict[Key, int] = {}
        self.frees: dict[str, list[Key]] = {}
        self.falls: set[str] = set()
        for location, pile in self.piles.items():
            self._add_pile(location, pile, location in instance.stacks and options.topple, options.max_topple)
        self.costs.update({("at", base, q): 0 for base in moving for q in self.piles})
        self.unit = math.gcd(*self.costs.values()) or 1
        self.cycles: list[Row] = []

    def _add_pile(self, location: str, pile: tuple[str, ...], topples: bool, most: int | None) -> None:
        size = min(most or len(pile), len(pile))
        runs = [("topple", location, low, low + size - 1) for low in range(1, len(pile) - size + 2)] if pile else []
        for height, block in enumerate(pile, start=1):
            cost = 0 if topples and block not in self.tower else MOVE
            if block in self.leaves:
                self.base += cost
            else:
                self.costs[REMOVED, block] = cost
            if topples:
                self.frees[block] = [run for low, run in enumerate(runs, start=1) if low <= height < low + size]
                self.costs.update(dict.fromkeys(self.frees[block], TOPPLE))
                if block not in self.tower:
                    self.falls.add(block)
            elif block in self.tower:
                self.frees[block] = [("aside", block)]
                self.costs["aside", block] = ASIDE

    def cost(self, key: Key) -> int:
        """Return what a choice costs.

        Raises:
            RefusedCertificate: where it is none.
        """
        if key in self.costs:
            return self.costs[key]
        if len(key) == 3 and key[0] == "under" and key[1] != key[2] and {key[1], key[2]} <= set(self.loose):
            return 0
        raise RefusedCertificate(f"a case distinguishes {list(key)}, which is no choice")

    def row(self, name: Key) -> Row:
        """Return the row of a name.

        Raises:
            RefusedCertificate: where there is none.
        """
        match name:
            case ("cycle", int(number)) if 0 <= number < len(self.cycles):
                return self.cycles[number]
            case ("place", str(base)) if base in self.bottoms or base in self.loose:
                # A tower begun anew has one place, another none.
                return self._with_removal({("at", base, q): 1 for q in self.piles}, base, -1, equal=True)
            case ("floor", str(location)) if location in self.piles:
                # One bottom at the most, and where a pile stands only if its lowest block leaves.
                wanted: dict[Key, int] = {("at", base, location): -1 for base in self.bottoms}
                pile = self.piles[location]
                return self._with_removal(wanted, pile[0], 1) if pile else Row(-1, wanted)
            case ("above", str(block)) if (REMOVED, block) in self.costs and self.spot[block][1]:
                location, height = self.spot[block]
                return self._with_removal({(REMOVED, block): 1}, self.piles[location][height - 1], -1)
            case ("falls", str(block)) if block in self.falls:
                # Picked and placed it would cost more than the topple of a run.
                return self._with_removal(dict.fromkeys(self.frees[block], 1), block, -1)
            case ("order", str(one), str(other), str(location)) if location in self.piles:
                if one != other and one in self.loose and other in self.loose:
                    either: dict[Key, int] = {("under", one, other): 1, ("under", other, one): 1}
                    return Row(-1, {**either, ("at", one, location): -1, ("at", other, location): -1})
        raise RefusedCertificate(f"a leaf gives a weight to {list(name)}, which is no row")

    def _with_removal(self, signs: dict[Key, int], block: str, sign: int, *, equal: bool = False) -> Row:
        """Add `sign` times whether a block leaves, and ask for 0 in all."""
        if block in self.leaves:
            return Row(-sign, signs, equal)
        return Row(0, {**signs, (REMOVED, block): sign}, equal)

    def cycle_row(self, number: int, cycle: ConditionalCycle) -> Row:
        """Check one cycle and return its row: a condition does not hold, or a block that would move directly is freed.

        Raises:
            RefusedCertificate: where it is no cycle.
        """
        given = self._given(number, cycle.given)
        frees: set[Key] = set()
        strict = False
        for before, after in zip(cycle.events, [*cycle.events[1:], *cycle.events[:1]], strict=True):
            if before[0] == PLACED and after == (REMOVED, before[1]):
                self._exists(number, after, given)
                frees.update(self.frees.get(before[1], ()))
            else:
                strict |= self._precedes(number, before, after, given)
        if not strict:
            raise RefusedCertificate(f"cycle {number}: all of its events may be one")
        signs: dict[Key, int] = dict.fromkeys(frees, 1)
        least = 1
        for condition in given.conditions:
            if condition[0] == "stays":
                signs[REMOVED, condition[1]] = signs.get((REMOVED, condition[1]), 0) + 1
            elif condition[0] != REMOVED or condition in self.costs:  # else it holds in any case
                signs[condition] = signs.get(condition, 0) - 1
                least -= 1
        return Row(least, signs)

    def _given(self, number: int, stated: Iterable[list[str]]) -> _Given:
        conditions = frozenset(map(tuple, stated))
        leaves = set(self.leaves)
        for condition in conditions:
            match condition:
                case ("removed", block) if block in self.spot or block in self.leaves:
                    leaves.add(block)
                case ("at", base, location) if (base in self.bottoms or base in self.loose) and location in self.piles:
                    leaves.add(base)
                    if base in self.bottoms:
                        leaves.update(self.piles[location])
                case ("under", lower, upper) if lower != upper and lower in self.loose and upper in self.loose:
                    leaves.update((lower, upper))
                case ("stays", block) if (REMOVED, block) in self.costs:
                    pass
                case _:
                    raise RefusedCertificate(f"cycle {number}: {list(condition)} is no condition")
        for pile in self.piles.values():  # what stands on a block that leaves, leaves too
            lowest = next((n for n, block in enumerate(pile) if block in leaves), len(pile))
            leaves.update(pile[lowest:])
        return _Given(conditions, frozenset(leaves))

    def _exists(self, number: int, event: tuple[str, str], given: _Given) -> None:
        kind, block = event
        known = self.tower if kind == PLACED else self.spot
        if kind in (REMOVED, PLACED) and block in known and block in given.leaves:
            return
        raise RefusedCertificate(f"cycle {number}: {block!r} need not be {kind}")

    def _precedes(self, number: int, before: tuple[str, str], after: tuple[str, str], given: _Given) -> bool:
        """Check that an event comes no later than another; whether it comes before it, in other transfers.

        Raises:
            RefusedCertificate: where that need not be so under the conditions.
        """
        self._exists(number, before, given)
        self._exists(number, after, given)
        match before[0], after[0]:
            case "removed", "removed":
                upper, lower = self.spot[before[1]], self.spot[after[1]]
                if upper[0] == lower[0] and upper[1] > lower[1]:
                    return False
            case "removed", "placed":
                if self._in_the_way(before[1], after[1], given):
                    return True
                if before[1] == after[1]:
                    return False
            case "placed", "placed":
                tower, rank = self.tower[before[1]]
                if self.tower[after[1]][0] == tower and rank < self.tower[after[1]][1]:
                    return True
                if rank == len(tower) - 1 and self._below(tower[0], after[1], given):
                    return True
        text = f"{before[1]!r} need not be {before[0]} before {after[1]!r} is {after[0]}"
        raise RefusedCertificate(f"cycle {number}: {text}")

    def _in_the_way(self, block: str, placed: str, given: _Given) -> bool:
        """Whether a block stands where, or on what, another is to be placed for good."""
        location, height = self.spot[block]
        tower, rank = self.tower[placed]
        if rank:
            under = self.spot.get(tower[rank - 1])
            return under is not None and under[0] == location and under[1] < height
        return ("at", placed, location) in given.conditions

    def _below(self, lower: str, upper: str, given: _Given) -> bool:
        """Whether the tower on base `lower` is below the tower on base `upper`, at one location."""
        if upper not in self.loose or lower == upper:
            return False
        if ("under", lower, upper) in given.conditions:
            return True
        if ("stays", lower) in given.conditions:
            return ("at", upper, self.spot[lower][0]) in given.conditions
        places = {q for q in self.piles if ("at", upper, q) in given.conditions}
        return lower in self.bottoms and any(("at", lower, q) in given.conditions for q in places)

    def least(self, proof: NamedLeaf | NamedCases, fixed: dict[Key, int]) -> int:
        """Return what the choices cost at least, where those of `fixed` are made as it says."""
        if isinstance(proof, NamedCases):
            key = tuple(proof.choice)
            self.cost(key)
            return min(self.least(proof.taken, {**fixed, key: 1}), self.least(proof.untaken, {**fixed, key: 0}))
        total = 0
        spare = {key: ONE * self.cost(key) for key in fixed}
        for name, weight in proof.rows:
            row = self.row(tuple(name))
            if weight < 0 and not row.equal:
                raise RefusedCertificate(f"a leaf gives {name} the weight {weight}")
            total += weight * row.least
            for key, sign in row.signs.items():
                spare[key] = spare.get(key, ONE * self.costs.get(key, 0)) - weight * sign
        total += sum(left * fixed[key] if key in fixed else min(0, left) for key, left in spare.items())
        return -(-total // (ONE * self.unit)) * self.unit


def proven_by_places(instance: Instance, options: PlanOptions, stated: PlacesProof) -> int:
    """Return the lower bound that a proof gives for a posed instance with an empty hand.

    Raises:
        RefusedCertificate: with the step that does not hold.
    """
    checker = PlacesChecker(instance, options)
    for number, cycle in enumerate(stated.cycles):
        checker.cycles.append(checker.cycle_row(number, cycle))
    return checker.base + checker.least(stated.proof, {})


def wrong_relations(instance: Instance, goal: OnGoal) -> set[str]:
    """Return the blocks that stand on another than wanted, or where another or none is wanted."""
    carried = {under: upper for upper, under in goal.on.items()}
    grounded, clear = {*goal.bottom, *goal.ontable}, frozenset(goal.clear)
    wrong = set()
    for pile in instance.start.values():
        for under, block in zip((None, *pile), pile, strict=False):
            misplaced = goal.on.get(block, under) != under or (block in grounded and under is not None)
            if misplaced or (under is not None and (under in clear or carried.get(under, block) != block)):
                wrong.add(block)
    return wrong
