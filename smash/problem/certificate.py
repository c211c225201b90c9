"""Certificates of optimality, and their checker: a lower bound that anyone can follow, without a solver.

A certificate lists cycles of precedence (`docs/theory.md`). Cycle `[b, c, d]` claims that the first removal of b
comes before the last placement of c, that of c before that of d, that of d before that of b; if each of the three moved
once, straight to its place, its removal would be its placement, and each would come before itself. So at
least one of them is toppled at its first removal or put aside: the cycle is *hit*. What hits all cycles for
the least cost is bounded from below by weights on the cycles (linear programming duality), or by a tree of
cases with weights at its leaves. A *rank* is a set of blocks of which no more than so many can move directly without
a cycle; the checker counts how many, and the others have to be freed. The checker knows the instance and the law's
actions, and nothing of the planner.

Where the hand holds a block at the start, every plan begins with a place: there is a proof for one location of each
class of equal ones, and the least of their bounds, and 1 for the place, is the bound.
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass
from typing import Literal, NamedTuple, cast

import msgspec

from smash.problem.actions.registry import kinds_of
from smash.problem.certificate_places import ONE, Key, PlacesProof, proven_by_places, wrong_relations
from smash.problem.errors import RefusedCertificate, Unsupported
from smash.problem.files.documents import convert, parse_json, read_bytes
from smash.problem.hand import after_place, distinct_locations
from smash.problem.model import Instance, OnGoal, PlanOptions, StacksGoal
from smash.problem.problem import Problem
from smash.problem.views.posed import posed

CERTIFICATE_FORMAT = "smash-certificate/1"
MOST_OF_A_RANK = 16
"""Blocks of one rank: the checker may have to look at each of its subsets."""
PLACE_COST = 1
"""Of the first action of a plan whose hand is full at the start."""


class Leaf(msgspec.Struct, forbid_unknown_fields=True, tag_field="kind", tag="weights"):
    """A case closed by weights: `[number of the cycle, millionths]` each; ranks are numbered on after the cycles."""

    weights: list[tuple[int, int]]


class Cases(msgspec.Struct, forbid_unknown_fields=True, tag_field="kind", tag="cases"):
    """Two cases: a choice (`["aside", block]` or `["topple", location, low, high]`) is taken, or it is not."""

    choice: list[str | int]
    taken: Leaf | Cases
    untaken: Leaf | Cases


class FirstPlace(msgspec.Struct, forbid_unknown_fields=True):
    """The proof for a start with a full hand where the block is put on the location `place` first."""

    place: str
    bound: int
    cycles: list[list[str]]
    proof: Leaf | Cases
    ranks: list[list[str]] = msgspec.field(default_factory=list)
    places: PlacesProof | None = None


class Certificate(msgspec.Struct, forbid_unknown_fields=True):
    """A `smash-certificate/1` document; `note` says what it does not prove.

    `first_places` stand in place of `cycles` and `proof` where the hand holds a block at the start, `places` where the
    goal is an `on` goal and the choice of its towers' places is part of the argument.
    """

    format: Literal["smash-certificate/1"]
    instance: str
    topple: bool
    max_topple: int | None
    bound: int
    cycles: list[list[str]]
    proof: Leaf | Cases
    note: str = ""
    first_places: list[FirstPlace] = msgspec.field(default_factory=list)
    ranks: list[list[str]] = msgspec.field(default_factory=list)
    places: PlacesProof | None = None


def read_certificate(path: str | os.PathLike[str]) -> Certificate:
    """Read a `smash-certificate/1` file.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    where = os.fspath(path)
    return cast(Certificate, convert(parse_json(read_bytes(path), where), Certificate, where))


def certificate_text(certificate: Certificate) -> str:
    """Return the text of a `smash-certificate/1` file."""
    document = msgspec.to_builtins(certificate)
    if not certificate.first_places:
        del document["first_places"]
    for part in (document, *document.get("first_places", ())):
        if not part["ranks"]:
            del part["ranks"]
        if part["places"] is None:
            del part["places"]
    return json.dumps(document) + "\n"


@dataclass(frozen=True, slots=True)
class _Choice:
    blocks: frozenset[str]
    cost: int


def why_not_certified(instance: Instance, options: PlanOptions) -> str | None:
    """Return why the argument of certificates does not cover a problem, or None where it does.

    It counts picks, places and topples at cost 1 of blocks that start at locations, in the table region or in the hand.
    """
    further = [kind.name for kind in kinds_of(instance, options) if kind.name != "topple"]
    if further:
        return f"plans may use {' and '.join(further)}, the proof counts picks, places and topples alone"
    if not instance.costs.plain:
        return "its actions have costs, the proof counts each as 1"
    if any(carrier.holds for carrier in instance.carriers):
        return "blocks start on a carrier, the proof knows locations and the table region alone"
    return None


def proven_bound(instance: Instance, options: PlanOptions, certificate: Certificate) -> int:
    """Check a certificate from the ground up and return the lower bound that it proves.

    Raises:
        RefusedCertificate: with the step that does not hold.
        Unsupported: where the argument does not cover the instance (`why_not_certified`).
    """
    why_not = why_not_certified(instance, options)
    if why_not is not None:
        raise Unsupported(f"{instance.name}: no certificate proves a bound here: {why_not}")
    if certificate.instance != instance.name:
        raise RefusedCertificate(f"it is for instance {certificate.instance!r}, not {instance.name!r}")
    if (certificate.topple, certificate.max_topple) != (options.topple, options.max_topple):
        raise RefusedCertificate("its topple options are not those of the plan")
    if instance.hand is None:
        if certificate.first_places:
            raise RefusedCertificate("it has first places, and the hand is empty at the start")
        bound = _proven(instance, options, certificate)
    else:
        bound = _proven_first_places(instance, options, certificate)
    if bound != certificate.bound:
        raise RefusedCertificate(f"it states the bound {certificate.bound}, its proof gives {bound}")
    return bound


def first_problems(instance: Instance, options: PlanOptions) -> dict[str, Instance]:
    """Return, by the first place, what is left to do where the hand holds a block: only what has a plan."""
    rests = {location: after_place(instance, location) for location in distinct_locations(instance)}
    return {at: rest for at, rest in rests.items() if Problem(rest, options).infeasible is None}


def _proven_first_places(instance: Instance, options: PlanOptions, certificate: Certificate) -> int:
    rests = first_problems(instance, options)
    places = [first.place for first in certificate.first_places]
    if sorted(places) != sorted(rests) or not places:
        raise RefusedCertificate(f"it is about the first places {sorted(places)}, not {sorted(rests)}")
    if certificate.places is not None or _has_plain_proof(certificate):
        raise RefusedCertificate("it has a proof beside those of its first places")
    for first in certificate.first_places:
        bound = _proven(rests[first.place], options, first)
        if bound != first.bound:
            raise RefusedCertificate(f"first place {first.place!r}: the bound is {bound}, not {first.bound}")
    return PLACE_COST + min(first.bound for first in certificate.first_places)


def _proven(instance: Instance, options: PlanOptions, stated: Certificate | FirstPlace) -> int:
    asked = posed(instance, falls=options.topple)
    if stated.places is not None:
        if _has_plain_proof(stated):
            raise RefusedCertificate("it has a proof beside that of its places")
        return proven_by_places(asked, options, stated.places)
    checker = _Checker(asked, options)
    for number, cycle in enumerate(stated.cycles):
        checker.add_cycle(number, cycle)
    for number, rank in enumerate(stated.ranks):
        checker.add_rank(number, rank)
    return checker.base + checker.least(stated.proof, frozenset(), frozenset())


def _has_plain_proof(stated: Certificate | FirstPlace) -> bool:
    return bool(stated.cycles or stated.ranks or stated.proof != Leaf([]))


class _Row(NamedTuple):
    """So many blocks have to be freed, and how many of them each choice frees."""

    needed: int
    frees: dict[Key, int]

    def left(self, taken: frozenset[Key]) -> int:
        """Return how many are still to be freed where some choices are taken."""
        return self.needed - sum(count for key, count in self.frees.items() if key in taken)


class _Checker:
    """Derives from the instance which blocks move, in which order, and what can hit a cycle at which cost."""

    def __init__(self, instance: Instance, options: PlanOptions) -> None:
        goal = instance.goal
        self.start = {location: pile for location, pile in instance.start.items() if pile}
        if isinstance(goal, OnGoal):
            self.towers: dict[str | int, tuple[str, ...]] = dict(enumerate(goal.towers()))
            wrong = wrong_relations(instance, goal)
        else:
            piles = goal.stacks if isinstance(goal, StacksGoal) else goal.stacks()
            self.towers = {location: tuple(pile) for location, pile in piles.items()}
            wrong = _wrong_positions(instance, {location: tuple(pile) for location, pile in piles.items()})
        self.at: dict[str, tuple[str, int]] = {}
        self.leaving: dict[str, tuple[str, ...]] = {}
        for location, pile in self.start.items():
            self.at.update((block, (location, height)) for height, block in enumerate(pile, start=1))
            lowest = next((height for height, block in enumerate(pile) if block in wrong), len(pile))
            self.leaving[location] = pile[lowest:]
        self.leaves = {block for pile in self.leaving.values() for block in pile}
        self.rank = {block: (key, rank) for key, tower in self.towers.items() for rank, block in enumerate(tower)}
        self.placed = {block for block in self.rank if block in self.leaves or block not in self.at}
        stacks = frozenset(instance.stacks) if options.topple else frozenset()
        loose = self.leaves - self.placed
        self.must_fall = {block for block in loose if self.at[block][0] in stacks}
        self.base = 2 * (len(self.placed) + len(loose - self.must_fall))
        self.choices: dict[Key, _Choice] = {}
        for location, pile in self.leaving.items():
            if location in stacks:
                size = min(options.max_topple or len(pile), len(pile))
                for first in range(len(pile) - size + 1 if pile else 0):
                    low = self.at[pile[first]][1]
                    run = frozenset(pile[first : first + size])
                    self.choices["topple", location, low, low + size - 1] = _Choice(run, 1)
            else:
                for block in self.placed.intersection(pile):
                    self.choices["aside", block] = _Choice(frozenset({block}), 2)
        self.unit = math.gcd(*(choice.cost for choice in self.choices.values())) if self.choices else 1
        self.rows: list[_Row] = []

    def add_cycle(self, number: int, cycle: list[str]) -> None:
        """Check one cycle and note what can hit it."""
        if not cycle or not self.leaves.issuperset(cycle):
            raise RefusedCertificate(f"cycle {number}: not every block of {cycle} has to leave its start pile")
        if len(cycle) > 1 or cycle[0] not in self.must_fall:
            for before, after in zip(cycle, [*cycle[1:], cycle[0]], strict=True):
                if not self._precedes(before, after):
                    text = f"the removal of {before!r} need not come before the placement of {after!r}"
                    raise RefusedCertificate(f"cycle {number}: {text}")
        self.rows.append(_Row(1, {key: 1 for key, choice in self.choices.items() if choice.blocks & set(cycle)}))

    def add_rank(self, number: int, blocks: list[str]) -> None:
        """Count how many of a set of blocks can move directly, and note what frees the others."""
        members = frozenset(blocks)
        if not members <= self.placed & self.leaves or not 0 < len(members) == len(blocks) <= MOST_OF_A_RANK:
            text = f"{blocks} are not up to {MOST_OF_A_RANK} blocks that leave their piles and are placed"
            raise RefusedCertificate(f"rank {number}: {text}")
        leads = [sum(self._precedes(one, other) << at for at, other in enumerate(blocks)) for one in blocks]
        needed = len(blocks) - _most_without_cycle(leads)
        frees = {key: len(choice.blocks & members) for key, choice in self.choices.items()}
        self.rows.append(_Row(needed, {key: min(count, needed) for key, count in frees.items() if count and needed}))

    def _precedes(self, before: str, after: str) -> bool:
        """Whether every plan removes `before` for the first time before it places `after` for the last time."""
        if after not in self.placed:
            return False
        location, height = self.at[before]
        tower, rank = self.rank[after]
        for under in self.towers[tower][: rank + 1]:
            if under not in self.placed:
                if self.at[under][0] == location:
                    return True  # the chain grows on a block that stays, and `before` is in the way above it
                continue
            if under in self.at and self.at[under][0] == location:
                lower = self.at[under][1]
                if lower < height or (lower == height and under != after):
                    return True
        return tower == location

    def least(self, proof: Leaf | Cases, taken: frozenset[Key], banned: frozenset[Key]) -> int:
        """Return what the choices cost at least, where those of `taken` are made and those of `banned` are not."""
        if isinstance(proof, Cases):
            key = tuple(proof.choice)
            if key not in self.choices:
                raise RefusedCertificate(f"a case distinguishes {list(key)}, which is no choice")
            return min(self.least(proof.taken, taken | {key}, banned), self.least(proof.untaken, taken, banned | {key}))
        total = ONE * sum(self.choices[key].cost for key in taken)
        load: dict[Key, int] = {}
        for number, weight in proof.weights:
            if not 0 <= number < len(self.rows) or weight < 0:
                raise RefusedCertificate(f"a leaf gives cycle {number} the weight {weight}")
            row = self.rows[number]
            left = row.left(taken)
            if left > 0:
                total += weight * left
                for key, count in row.frees.items():
                    load[key] = load.get(key, 0) + weight * count
        for key, weight in load.items():
            if key not in taken and key not in banned and weight > ONE * self.choices[key].cost:
                raise RefusedCertificate(f"the cycles hit by {list(key)} weigh more than it costs")
        return -(-total // (ONE * self.unit)) * self.unit


def _most_without_cycle(leads: list[int]) -> int:
    """Return how many vertices of a graph can be kept without a cycle.

    Args:
        leads: per vertex those that it leads to, as bits.
    """
    known = {0: 0}

    def most(kept: int) -> int:
        if kept not in known:
            cycle = _cycle_of(leads, kept)
            left = [kept & ~(1 << vertex) for vertex in cycle]
            known[kept] = max(map(most, left)) if cycle else kept.bit_count()
        return known[kept]

    return most((1 << len(leads)) - 1)


def _cycle_of(leads: list[int], kept: int) -> list[int]:
    """Return the vertices of a cycle among those of `kept`, of one or two where there is one; empty where none is."""
    while True:  # what leads to none of them is on no cycle
        ends = sum(1 << at for at, following in enumerate(leads) if kept >> at & 1 and not following & kept)
        if not ends:
            break
        kept &= ~ends
    members = [at for at in range(len(leads)) if kept >> at & 1]
    for one in members:
        for other in members:
            if leads[one] >> other & 1 and leads[other] >> one & 1:
                return [one] if one == other else [one, other]
    way: list[int] = []
    while members and (not way or members[0] not in way):
        way.append(members[0])
        members = [at for at in range(len(leads)) if leads[way[-1]] & kept & 1 << at]
    return way[way.index(members[0]) :] if members else []


def _wrong_positions(instance: Instance, piles: dict[str, tuple[str, ...]]) -> set[str]:
    """Return the blocks that stand where another is wanted, or are wanted elsewhere."""
    wanted = {block: (location, rank) for location, pile in piles.items() for rank, block in enumerate(pile)}
    wrong = set()
    for location, pile in instance.start.items():
        goal = piles.get(location, ())
        for rank, block in enumerate(pile):
            if wanted.get(block, (location, rank)) != (location, rank) or (rank < len(goal) and goal[rank] != block):
                wrong.add(block)
    return wrong
