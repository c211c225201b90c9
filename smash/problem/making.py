"""Instances from Python: what a start and a goal leave open follows from them, and the whole is checked."""

from __future__ import annotations

import itertools
from collections.abc import Container, Iterable, Iterator, Mapping
from typing import Any, TypeGuard

from smash.problem.costs import UNIT_COSTS, Costs
from smash.problem.errors import MalformedFile
from smash.problem.files.checking import checked
from smash.problem.model import TABLE, Carrier, Goal, Instance, OnGoal, PositionsGoal, StacksGoal, no_goal

Piles = Mapping[str, Iterable[str]]
"""Location -> blocks, bottom first."""


def make_instance(
    start: Piles,
    goal: Goal | Piles,
    *,
    name: str = "instance",
    blocks: Iterable[str] | None = None,
    stacks: Iterable[str] | int = (),
    buffers: Iterable[str] | int = (),
    table: Iterable[str] = (),
    carriers: Iterable[Carrier] = (),
    capacities: Mapping[str, int] | None = None,
    costs: Costs = UNIT_COSTS,
    hand: str | None = None,
    where: str = "instance",
) -> Instance:
    """Build an instance and check it whole. A start and a goal are enough.

    Example:
        `make_instance(start={"s1": ["a", "b"], "s2": ["c"]}, goal={"s2": ["c", "a", "b"]})`

    Args:
        start: location -> blocks, bottom first. A location that it leaves out is empty.
        goal: a `StacksGoal`, `PositionsGoal` or `OnGoal`; a mapping is the whole arrangement, as in `StacksGoal`.
        name: the instance's name.
        blocks: all blocks, in the order in which they are numbered; None: those of `start`, `table`, `carriers` and
            `hand`.
        stacks: names of stacks, which come first; locations that `start` and `goal` name beside them and beside the
            buffers are stacks too, in the order in which they appear. A number adds so many to those: `s1`, `s2`, …,
            names that are taken left out.
        buffers: names of all buffers, or their number: `u1`, `u2`, …, names that are taken left out.
        table: blocks that start in the table region.
        carriers: things that hold blocks and are moved with them.
        capacities: of the aggregating actions that need one: name -> most blocks.
        costs: what actions cost; every action 1, where it is left out.
        hand: the block that the hand holds at the start.
        where: what errors call the instance.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    holding, fallen = _carriers(carriers, where), _names("table", table, where)
    if not isinstance(costs, Costs):
        raise MalformedFile(where, f"`costs`: {costs!r} is not allowed; a Costs is")
    piles = _piles("start", start, where, letters=blocks is not None)
    meant = _goal(goal, where)
    named = [] if _is_number(buffers) else _names("buffers", buffers, where)
    given = [] if _is_number(stacks) else _names("stacks", stacks, where)
    follow = dict.fromkeys(at for at in (*piles, *_locations(meant)) if at not in given and at not in named)
    locations = [*given, *follow]
    if _is_number(stacks):
        locations += _fresh("stacks", "s", stacks, (*locations, *named), where)
    if _is_number(buffers):
        named = _fresh("buffers", "u", buffers, locations, where)
    held = None if hand is None else _name("hand", hand, where)
    if blocks is None:
        standing = [*piles.values(), fallen, *(carrier.holds for carrier in holding), () if held is None else (held,)]
        blocks = dict.fromkeys(block for pile in standing for block in pile)
    instance = Instance(
        name=_name("name", name, where),
        blocks=_names("blocks", blocks, where),
        stacks=tuple(locations),
        buffers=tuple(named),
        start=piles,
        goal=meant,
        table=fallen,
        carriers=holding,
        capacities=dict(_mapping("capacities", capacities or {}, where, "actions to numbers")),
        costs=costs,
        hand=held,
    )
    return checked(instance, where)


def fresh_names(letter: str, taken: Container[str]) -> Iterator[str]:
    """Yield `s1`, `s2`, … (with the letter `s`) without those that are taken."""
    return (name for number in itertools.count(1) if (name := f"{letter}{number}") not in taken)


def _fresh(part: str, letter: str, count: int, taken: tuple[str, ...] | list[str], where: str) -> list[str]:
    if count < 0:
        raise MalformedFile(where, f"`{part}`: {count} is not allowed; names, or a number from 0")
    return list(itertools.islice(fresh_names(letter, {*taken, TABLE}), count))


def _name(part: str, name: Any, where: str) -> str:
    if not isinstance(name, str):
        raise MalformedFile(where, f"`{part}`: {name!r} is no name; a string is one")
    return name


def _is_number(given: Iterable[str] | int) -> TypeGuard[int]:
    """Return whether a number of locations is given, not their names; True and False are none."""
    return isinstance(given, int) and not isinstance(given, bool)


def _carriers(carriers: Any, where: str) -> tuple[Carrier, ...]:
    held = tuple(carriers) if isinstance(carriers, Iterable) else (carriers,)
    if not all(isinstance(one, Carrier) for one in held):
        raise MalformedFile(where, f"`carriers`: {carriers!r} is not allowed; a list of Carrier is")
    return held


def _names(part: str, names: Any, where: str) -> tuple[str, ...]:
    """Return names as a tuple; anything else is refused."""
    if not isinstance(names, Iterable) or (isinstance(names, str) and part in ("stacks", "buffers")):
        raise MalformedFile(where, f"`{part}`: {names!r} is not allowed; a list of names is")
    return tuple(_name(part, name, where) for name in names)


def _mapping(part: str, given: Any, where: str, of: str) -> Mapping[Any, Any]:
    if not isinstance(given, Mapping):
        raise MalformedFile(where, f"`{part}`: {given!r} is not allowed; a mapping of {of} is")
    return given


def _piles(part: str, piles: Any, where: str, *, letters: bool) -> dict[str, tuple[str, ...]]:
    """Return piles as tuples; a text in place of a list is taken by its letters only where the blocks are known."""
    _mapping(part, piles, where, "locations to lists of blocks")
    for location, pile in piles.items():
        if isinstance(pile, str) and not letters:
            raise MalformedFile(where, f"`{part}.{location}`: {pile!r} is one name; a list of blocks is allowed")
    _names(part, piles, where)
    return {location: _names(f"{part}.{location}", pile, where) for location, pile in piles.items()}


def _goal(goal: Any, where: str) -> Goal:
    """Return the goal that is meant, its lists as tuples."""
    match goal:
        case StacksGoal(stacks):
            return StacksGoal(_piles("goal.stacks", stacks, where, letters=True))
        case PositionsGoal(positions):
            named = _mapping("goal.positions", positions, where, "blocks to (location, height)")
            return PositionsGoal({block: _position(block, at, where) for block, at in named.items()})
        case OnGoal(on, bottom, ontable, clear):
            under = _mapping("goal.on", on, where, "blocks to the block under each")
            relations = {upper: _name(f"goal.on.{upper}", lower, where) for upper, lower in under.items()}
            parts = {"bottom": bottom, "ontable": ontable, "clear": clear}
            return OnGoal(relations, *(_names(f"goal.{part}", blocks, where) for part, blocks in parts.items()))
        case Mapping():
            return StacksGoal(_piles("goal", goal, where, letters=False))
        case _:
            allowed = "a mapping of locations to lists of blocks, a StacksGoal, a PositionsGoal or an OnGoal is one"
            raise MalformedFile(where, f"`goal`: {goal!r} is no goal; {allowed}")


def _position(block: str, position: Any, where: str) -> tuple[str, int]:
    match position:
        case (str(location), int(height)) if not isinstance(height, bool):
            return location, height
    raise MalformedFile(where, f"`goal.positions.{block}`: {position!r} is not allowed; (location, height) is")


def _locations(goal: Goal) -> Iterable[str]:
    """Return the locations that a goal names."""
    match goal:
        case StacksGoal(stacks):
            return stacks
        case PositionsGoal(positions):
            return [location for location, _ in positions.values()]
        case OnGoal():
            return ()
        case _:
            no_goal(goal)
