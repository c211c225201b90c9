"""What makes an instance consistent: every name known and unique, every block once, no height that floats."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import NoReturn

from smash.problem.actions.registry import FAMILY
from smash.problem.errors import MalformedFile
from smash.problem.model import TABLE, Carrier, Instance, OnGoal, PositionsGoal, StacksGoal, no_goal

MOST_COST = 1_000_000
"""Highest cost of an action, and of a metre: sums of shares must stay exact in floating point."""
FARTHEST = 1000
"""Farthest that a place may be from the origin [m]."""


def checked(instance: Instance, where: str) -> Instance:
    """Return an instance that is sound, with every location in its start.

    Raises:
        MalformedFile: about the first defect.
    """
    InstanceChecker(instance, where).check()
    return replace(instance, start={location: instance.start.get(location, ()) for location in instance.locations})


class InstanceChecker:
    """Refuses an instance that contradicts itself; the first defect found is the one reported."""

    def __init__(self, instance: Instance, where: str) -> None:
        self.instance = instance
        self.where = where
        self.blocks = frozenset(instance.blocks)
        self.locations = frozenset(instance.locations)
        self.stacks = frozenset(instance.stacks)

    def refuse(self, part: str, problem: str) -> NoReturn:
        """Refuse the instance for a defect of one part of it."""
        raise MalformedFile(self.where, f"`{part}`: {problem}")

    def check(self) -> None:
        """Look at everything.

        Raises:
            MalformedFile: for the first defect.
        """
        self._names()
        for carrier in self.instance.carriers:
            self._carrier(carrier)
        self._capacities()
        self._costs()
        self._start()
        match self.instance.goal:
            case StacksGoal() as goal:
                self._stacks_goal(goal)
            case PositionsGoal() as goal:
                self._positions_goal(goal)
            case OnGoal() as goal:
                self._on_goal(goal)
            case _:
                no_goal(self.instance.goal)

    def _names(self) -> None:
        self._once("blocks", self.instance.blocks)
        self._once("stacks", self.instance.stacks)
        self._once("stacks and buffers", self.instance.locations)
        if not self.instance.stacks:
            self.refuse("stacks", "at least one location is needed")
        if TABLE in self.locations:
            self.refuse("stacks and buffers", f"{TABLE!r} names the table region; call the location otherwise")
        if self.instance.carriers:
            carriers = self.instance.carriers
            stations = {station for carrier in carriers for station in carrier.stations}
            self._once("carriers", [carrier.at for carrier in carriers])
            names = [TABLE, *self.instance.locations, *(carrier.name for carrier in carriers), *sorted(stations)]
            self._once("carriers: names of locations, carriers and stations", names)

    def _carrier(self, carrier: Carrier) -> None:
        part = f"carriers.{carrier.name}"
        self._once(f"{part}.stations", carrier.stations)
        if carrier.at not in carrier.stations:
            self.refuse(f"{part}.at", f"{carrier.at!r} is not one of its stations ({_listing(carrier.stations)})")
        if carrier.capacity < 1:
            self.refuse(f"{part}.capacity", f"{carrier.capacity} is not allowed; 1 and more")
        if len(carrier.holds) > carrier.capacity:
            self.refuse(f"{part}.holds", f"{len(carrier.holds)} blocks, the capacity is {carrier.capacity}")
        for block in carrier.holds:
            self._block(f"{part}.holds", block)

    def _capacities(self) -> None:
        known = [kind.name for kind in FAMILY.values() if kind.needs_capacity]
        for name, capacity in self.instance.capacities.items():
            if name not in known:
                self.refuse("capacities", f"{name!r} is not allowed; one of {', '.join(known)}")
            if capacity < 1:
                self.refuse(f"capacities.{name}", f"{capacity} is not allowed; 1 and more")

    def _costs(self) -> None:
        costs = self.instance.costs
        known = ("pick", "place", *FAMILY)
        for name, cost in costs.actions.items():
            if name not in known:
                self.refuse("costs.actions", f"{name!r} is not allowed; one of {', '.join(known)}")
            if not 1 <= cost <= MOST_COST:
                self.refuse(f"costs.actions.{name}", f"{cost} is not allowed; 1 to {MOST_COST:,}")
        if not 0 <= costs.travel <= MOST_COST:
            self.refuse("costs.travel", f"{costs.travel} is not allowed; 0 to {MOST_COST:,}")
        stations = [station for carrier in self.instance.carriers for station in carrier.stations]
        places = dict.fromkeys([*self.instance.locations, TABLE, *stations])
        for place, position in costs.positions.items():
            if place not in places:
                self.refuse("costs.positions", f"{place!r} is no place ({_listing(places)})")
            if not all(abs(part) <= FARTHEST for part in position):
                self.refuse(f"costs.positions.{place}", f"a position is two numbers from -{FARTHEST} to {FARTHEST} [m]")
        missing = [place for place in places if place not in costs.positions]
        if costs.travel and missing:
            self.refuse("costs.positions", f"{missing[0]!r} is missing; travel costs need every place")

    def _start(self) -> None:
        for location, pile in self.instance.start.items():
            self._location("start", location, self.locations, "a location of stacks or buffers")
            for block in pile:
                self._block(f"start.{location}", block)
        for block in self.instance.table:
            self._block("table", block)
        held = [] if self.instance.hand is None else [self.instance.hand]
        for block in held:
            self._block("hand", block)
        placed = [block for pile in self.instance.start.values() for block in pile] + list(self.instance.table)
        placed += held + [block for carrier in self.instance.carriers for block in carrier.holds]
        places = ["start", "table", *(["hand"] if held else []), *(["carriers"] if self.instance.carriers else [])]
        self._each_block_once(f"{', '.join(places[:-1])} and {places[-1]}", placed)

    def _stacks_goal(self, goal: StacksGoal) -> None:
        for location, pile in goal.stacks.items():
            self._location("goal.stacks", location, self.stacks, "a location of stacks")
            for block in pile:
                self._block(f"goal.stacks.{location}", block)
        self._each_block_once("goal.stacks", [block for pile in goal.stacks.values() for block in pile])

    def _positions_goal(self, goal: PositionsGoal) -> None:
        heights: dict[str, dict[int, str]] = {}
        for block, (location, height) in goal.positions.items():
            part = f"goal.positions.{block}"
            self._block("goal.positions", block)
            self._location(part, location, self.stacks, "a location of stacks")
            if height < 1:
                self.refuse(part, f"height {height} is not allowed; 1 is the bottom")
            other = heights.setdefault(location, {}).setdefault(height, block)
            if other != block:
                self.refuse(part, f"height {height} of {location!r} is also the goal of {other!r}")
        for location, taken in heights.items():
            for height in sorted(taken):
                if height > 1 and height - 1 not in taken:
                    part = f"goal.positions.{taken[height]}"
                    self.refuse(part, f"height {height} of {location!r} floats: no block has height {height - 1}")

    def _on_goal(self, goal: OnGoal) -> None:
        """Look at the names; a goal that contradicts itself is well formed (`smash.problem.feasibility`)."""
        for upper, under in goal.on.items():
            self._block("goal.on", upper)
            self._block(f"goal.on.{upper}", under)
        for part, blocks in (("bottom", goal.bottom), ("ontable", goal.ontable), ("clear", goal.clear)):
            self._once(f"goal.{part}", blocks)
            for block in blocks:
                self._block(f"goal.{part}", block)

    def _each_block_once(self, part: str, placed: list[str]) -> None:
        self._once(part, placed)
        known = set(placed)
        missing = [block for block in self.instance.blocks if block not in known]
        if missing:
            self.refuse(part, f"block {missing[0]!r} is nowhere; every block stands exactly once")

    def _once(self, part: str, names: Iterable[str]) -> None:
        seen: set[str] = set()
        for name in names:
            if name in seen:
                self.refuse(part, f"{name!r} stands twice; once is allowed")
            seen.add(name)

    def _block(self, part: str, block: str) -> None:
        if block not in self.blocks:
            self.refuse(part, f"{block!r} is not one of `blocks` ({_listing(self.instance.blocks)})")

    def _location(self, part: str, location: str, allowed: frozenset[str], what: str) -> None:
        if location not in allowed:
            names = [name for name in self.instance.locations if name in allowed]
            self.refuse(part, f"{location!r} is not {what} ({_listing(names)})")


def _listing(names: Iterable[str], most: int = 8) -> str:
    shown = [repr(name) for name in names]
    return ", ".join(shown[:most]) + (", …" if len(shown) > most else "") if shown else "none"
