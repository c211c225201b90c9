"""Instances, goals, actions and states of tabletop stack rearrangement (paper, section "Problem Formulation").

Heights are 1-based: 1 is the bottom. A *location* is a stack location; `stacks` are those that start and
goal use, `buffers` are interchangeable auxiliary ones. The *table region* is the paper's T_a: the place of
toppled blocks, whose poses are unknown to the planner.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NoReturn

from smash.problem.costs import UNIT_COSTS, Costs
from smash.problem.errors import SmashError
from smash.problem.words import counted

TABLE = "table"
"""The source name of a pick from the table region; no location may be called so."""


@dataclass(frozen=True, slots=True)
class Pick:
    """Take `block` from the top of location `source`, or from the table region (`source == TABLE`)."""

    block: str
    source: str

    def __str__(self) -> str:
        return f"pick {self.block!r} from {self.source!r}"


@dataclass(frozen=True, slots=True)
class Place:
    """Put the held `block` on top of location `target`."""

    block: str
    target: str

    def __str__(self) -> str:
        return f"place {self.block!r} on {self.target!r}"


class Aggregating:
    """Base of the actions that move several blocks at once: topple, carry, lift (`smash.problem.actions.kind`)."""

    __slots__ = ()


Action = Pick | Place | Aggregating


@dataclass(frozen=True, slots=True)
class StacksGoal:
    """The whole arrangement: each location holds exactly this list, bottom first; all else is empty."""

    stacks: Mapping[str, tuple[str, ...]]

    def __hash__(self) -> int:
        return hash(frozenset(self.stacks.items()))


@dataclass(frozen=True, slots=True)
class PositionsGoal:
    """Some blocks at an exact (location, height); per location the heights 1..k. The rest lies anywhere."""

    positions: Mapping[str, tuple[str, int]]

    def __hash__(self) -> int:
        return hash(frozenset(self.positions.items()))

    def stacks(self) -> dict[str, tuple[str, ...]]:
        """Return the listed blocks per location, bottom first; locations without one are left out."""
        piles: dict[str, list[tuple[int, str]]] = {}
        for block, (location, height) in self.positions.items():
            piles.setdefault(location, []).append((height, block))
        return {location: tuple(block for _, block in sorted(pile)) for location, pile in piles.items()}


@dataclass(frozen=True, slots=True)
class OnGoal:
    """Relations only; any location serves (the classical blocks world, the paper's "goal sets").

    One that contradicts itself (a block on itself, two directly on one) is well formed and has no plan.

    Attributes:
        on: `on[a] == b` wants a directly on b.
        bottom: each of these at the bottom of some location.
        ontable: each of these on the table: at the bottom of some location or in the table region.
        clear: on each of these lies nothing.
    """

    on: Mapping[str, str]
    bottom: tuple[str, ...] = ()
    ontable: tuple[str, ...] = ()
    clear: tuple[str, ...] = ()

    def __hash__(self) -> int:
        return hash((frozenset(self.on.items()), self.bottom, self.ontable, self.clear))

    def towers(self) -> list[tuple[str, ...]]:
        """Return the goal's towers, bottom first; a block of `bottom` that carries nothing is one of height 1.

        Blocks that would stand on themselves are in none.
        """
        above = {under: upper for upper, under in self.on.items()}
        bases = [b for b in above if b not in self.on] + [b for b in self.bottom if b not in above]
        towers = []
        for base in bases:
            tower = [base]
            while tower[-1] in above:
                tower.append(above[tower[-1]])
            towers.append(tuple(tower))
        return towers


Goal = StacksGoal | PositionsGoal | OnGoal


def no_goal(goal: object) -> NoReturn:
    """Refuse what is no goal: the last case of whoever asks for the kind of one.

    Raises:
        SmashError: naming what a goal is.
    """
    raise SmashError(f"{goal!r} is no goal; a StacksGoal, a PositionsGoal or an OnGoal is one")


@dataclass(frozen=True, slots=True)
class Carrier:
    """A movable thing that holds blocks side by side (the paper's scoop): blocks are picked off and placed on it.

    Attributes:
        name: a source of picks and a target of places.
        stations: where it can stand.
        at: the station where it starts.
        capacity: most blocks on it.
        holds: the blocks that start on it.
    """

    name: str
    stations: tuple[str, ...]
    at: str
    capacity: int
    holds: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Instance:
    """One rearrangement problem. `start` names every location (empty ones too), bottom first.

    `carriers`, `capacities` (of the aggregating actions that need one: name -> most blocks), `costs`, `hand` (the block
    that the hand holds at the start) and an `on` goal's `ontable` and `clear` are what version 2 of the format adds;
    without carriers, capacities and costs the actions are pick, place and topple, each at cost 1.

    Build it by `read_instance` or `make_instance`, which check it; the fields are then trusted. Equal instances have
    equal hashes, so that they can be kept in a set; nobody changes the mappings of one.
    """

    name: str
    blocks: tuple[str, ...]
    stacks: tuple[str, ...]
    buffers: tuple[str, ...]
    start: Mapping[str, tuple[str, ...]]
    goal: Goal
    table: tuple[str, ...] = ()
    carriers: tuple[Carrier, ...] = ()
    capacities: Mapping[str, int] = field(default_factory=dict)
    costs: Costs = UNIT_COSTS
    hand: str | None = None

    @property
    def locations(self) -> tuple[str, ...]:
        """All stack locations: `stacks`, then `buffers`."""
        return self.stacks + self.buffers

    def __hash__(self) -> int:
        start = frozenset(self.start.items())
        return hash((self.name, self.blocks, self.stacks, self.buffers, start, self.table, self.hand))

    def __repr__(self) -> str:
        kind = type(self.goal).__name__
        held = "" if self.hand is None else f"{self.hand!r} in the hand, "
        return (
            f"<Instance {self.name!r}: {counted(len(self.blocks), 'block')} on {counted(len(self.stacks), 'stack')} "
            f"and {counted(len(self.buffers), 'buffer')}, {held}{kind}>"
        )

    def _repr_svg_(self) -> str | None:
        """Return start and goal as a picture, for notebooks; None where the goal is none."""
        from smash.problem.pictures import Arrangement, arrangements_svg  # solving needs none

        try:
            wanted, columns, remark = shown_goal(self)
        except SmashError:
            return None
        shown = shown_locations(self)
        further = [(carrier.name, carrier.holds) for carrier in self.carriers]
        further += [] if self.hand is None else [("hand", (self.hand,))]
        start = Arrangement(
            f"start{idle_remark(self)}", [*((at, self.start[at]) for at in shown), *further], self.table
        )
        goal = Arrangement(f"goal{remark}", [(at, wanted.get(at, ())) for at in columns])
        return arrangements_svg([start, goal], self.blocks)


def shown_locations(instance: Instance) -> tuple[str, ...]:
    """Return the locations that a picture of the start shows: all but the empty buffers."""
    return instance.stacks + tuple(buffer for buffer in instance.buffers if instance.start[buffer])


def idle_remark(instance: Instance) -> str:
    """Return how many empty buffers a picture of the start leaves out, in words; nothing where there is none."""
    idle = len(instance.locations) - len(shown_locations(instance))
    return f" ({counted(idle, 'empty buffer')} beside)" if idle else ""


def shown_goal(instance: Instance) -> tuple[dict[str, tuple[str, ...]], tuple[str, ...], str]:
    """Return what the goal asks for as piles, the columns to draw them on, and a remark for the title."""
    match instance.goal:
        case StacksGoal(stacks):
            return dict(stacks), instance.stacks, ""
        case PositionsGoal() as goal:
            return goal.stacks(), instance.stacks, " (the rest anywhere)"
        case OnGoal() as goal:
            return _shown_relations(goal)
        case _:
            no_goal(instance.goal)


def _shown_relations(goal: OnGoal) -> tuple[dict[str, tuple[str, ...]], tuple[str, ...], str]:
    """Return the towers of an `on` goal as columns that say what they stand on, and a remark."""
    bottom, ontable = set(goal.bottom), set(goal.ontable)
    loaded = set(goal.on.values())
    towers = goal.towers()
    towers += [(block,) for block in goal.ontable if not (block in bottom or block in loaded or block in goal.on)]
    piles = {}
    for number, tower in enumerate(towers):
        grounded = tower[0] in bottom or (tower[0] in ontable and len(tower) > 1)
        under = "floor" if grounded else "table" if tower[0] in ontable else "any"
        piles[f"{under} {number}"] = tower
    remark = "at any location, on its floor or on anything"
    if any(column.startswith("table") for column in piles):
        remark = "any location; table: a floor or the table region"
    if goal.clear:
        remark += f"; clear: {_listed(goal.clear)}"
    return piles, tuple(piles), f" ({remark})"


@dataclass(frozen=True, slots=True)
class PlanOptions:
    """What a plan may use.

    Attributes:
        topple: whether topple is allowed.
        max_topple: most blocks of one topple.
        without: names of further aggregating actions that are not allowed.
    """

    topple: bool = True
    max_topple: int | None = None
    without: tuple[str, ...] = field(default=(), kw_only=True)

    def allows(self, name: str) -> bool:
        """Return whether the aggregating action called `name` is allowed."""
        return self.topple if name == "topple" else name not in self.without

    def includes(self, narrow: PlanOptions) -> bool:
        """Return whether every plan under `narrow` is one under these, so that their bounds hold for `narrow` too."""
        if not set(self.without) <= set(narrow.without):
            return False
        if not narrow.topple or not self.topple:
            return not narrow.topple
        return self.max_topple is None or (narrow.max_topple is not None and narrow.max_topple <= self.max_topple)


@dataclass(slots=True)
class State:
    """Where every block is: `piles` per location (bottom first), `table` (the paper's T_a), `hand`.

    `carried` are the blocks on each carrier, `stations` where the carriers stand. `origin` is the place that the held
    block was taken from, kept where travel costs.

    Mutable, so that a plan of any length is checked in time linear in its length; `copy` before you branch.
    """

    piles: dict[str, list[str]]
    table: set[str] = field(default_factory=set)
    hand: str | None = None
    carried: dict[str, set[str]] = field(default_factory=dict)
    stations: dict[str, str] = field(default_factory=dict)
    origin: str | None = None

    @classmethod
    def start_of(cls, instance: Instance) -> State:
        """Return the start state of `instance`."""
        return cls(
            piles={location: list(instance.start.get(location, ())) for location in instance.locations},
            table=set(instance.table),
            hand=instance.hand,
            carried={carrier.name: set(carrier.holds) for carrier in instance.carriers},
            stations={carrier.name: carrier.at for carrier in instance.carriers},
        )

    def copy(self) -> State:
        """Return an independent copy."""
        return State(
            {location: list(pile) for location, pile in self.piles.items()},
            set(self.table),
            self.hand,
            {name: set(blocks) for name, blocks in self.carried.items()},
            dict(self.stations),
            self.origin,
        )

    def key(self) -> Hashable:
        """Return a hashable value that is equal for equal states."""
        return (
            tuple((k, tuple(v)) for k, v in sorted(self.piles.items())),
            frozenset(self.table),
            self.hand,
            tuple((k, frozenset(v), self.stations[k]) for k, v in sorted(self.carried.items())),
            self.origin,
        )

    def place_of(self, name: str) -> str:
        """Return the point in space that a source or target stands for: a carrier's is its station."""
        return self.stations.get(name, name)

    def __str__(self) -> str:
        """A line for each pile, its blocks from the bottom to the top, then what is empty, the table, the hand."""
        lines = [f"{_plain(location)}: {_listed(pile)}" for location, pile in self.piles.items() if pile]
        empty = [location for location, pile in self.piles.items() if not pile]
        if empty:
            lines.append(f"empty: {_listed(empty)}")
        for carrier, blocks in self.carried.items():
            lines.append(f"{_plain(carrier)} at {_plain(self.stations[carrier])}: {_listed(sorted(blocks)) or 'empty'}")
        if self.table:
            lines.append(f"{TABLE} region: {_listed(sorted(self.table))}")
        lines.append("hand: " + ("empty" if self.hand is None else _plain(self.hand)))
        return "\n".join(lines)

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        """Print the piles in a notebook."""
        printer.text(str(self))


def _listed(names: Iterable[str]) -> str:
    return " ".join(map(_plain, names))


def _plain(name: str) -> str:
    """Return a name as it stands in a line of text: in quotes where it would not be told apart there."""
    return name if name.isprintable() and name and " " not in name else repr(name)
