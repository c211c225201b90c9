"""What a plan costs whatever its order: a flow of every block from its start to its goal, without time.

Each block is one unit of flow over the places (paper, section "Computing a candidate task plan on the gadget", with
all time steps laid on one another); a topple, a carry and a lift are counted, and paid once for all the blocks that
they move. A plan's actions, added up, are such a flow, so that its least cost bounds every plan; and so does, for
plans below a cost, its largest number of actions: that many layers hold them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from smash.planners.layered.network.moving import Moving
from smash.planners.layered.network.places import NO_EDGE, free
from smash.planners.milp.arrays import Ints, Milp, MilpBuilder
from smash.problem.problem import Problem

COUNT_WEIGHT = -1.0
"""Of each action, where as many as possible are looked for."""


@dataclass(frozen=True, slots=True)
class UnorderedModel:
    """The MILP; no plan is read from it."""

    milp: Milp


def build_cheapest(problem: Problem, moving: Moving, deadline: float = math.inf) -> UnorderedModel:
    """Build the program whose optimum bounds the cost of every plan.

    Args:
        problem: what is planned.
        moving: its moving blocks.
        deadline: when to give up [s, clock of `perf_counter`].

    Raises:
        OutOfTime: where the deadline has passed.
    """
    return UnorderedModel(_Builder(problem, moving, None, deadline).build())


def build_longest(problem: Problem, moving: Moving, below: int, deadline: float = math.inf) -> UnorderedModel:
    """Build the program whose optimum, negated, bounds the actions of a cheapest plan, if it costs less than `below`.

    A transfer counts one. It is infeasible where no plan costs less than `below`.

    Args:
        problem: what is planned.
        moving: its moving blocks.
        below: what the plan has to be cheaper than.
        deadline: when to give up [s, clock of `perf_counter`].

    Raises:
        OutOfTime: where the deadline has passed.
    """
    return UnorderedModel(_Builder(problem, moving, below, deadline).build())


class _Builder:
    """Adds columns, then rows. Node and edge names as in `smash.planners.layered.network.moving`."""

    def __init__(self, problem: Problem, moving: Moving, below: int | None, deadline: float) -> None:
        self.start = problem.instance.start
        self.cap = problem.options.max_topple
        self.moving, self.places = moving, moving.places
        self.below = below
        self.milp = MilpBuilder(deadline)
        self.prices: list[tuple[Ints, Ints]] = []

    def build(self) -> Milp:
        places, moving = self.places, self.moving
        n, locations, decks = len(moving.blocks), len(places.locations), len(places.decks)
        self.move = self._edges(moving.transfers(), priced=True)
        self.fall, self.lifted = self._edges(moving.falls()), self._edges(moving.lifts())
        self.ride = self._edges(np.broadcast_to(free(places.carry), (n, decks, decks)))
        price = np.full(locations, NO_EDGE, dtype=np.int64)
        price[: places.toppled] = places.topple
        self.topple = self._edges(price, priced=True)
        self.carry = self._edges(places.carry, priced=True)
        self.lift = self._edges(places.lift, priced=True)
        # Moves that the flow forgets (a third one of a block without a goal, one of a block that may stay).
        there = places.transfer[places.transfer >= 0]
        self.forgotten = self._edges(np.array([there.min() if there.size else NO_EDGE]), priced=True)
        self.ends = self.milp.add_columns(n * (locations + decks)).reshape(n, -1)
        self.stop = self.milp.add_columns(decks)
        self._conserve()
        self._activations()
        self._carriers()
        self._counts()
        return self.milp.build()

    def _edges(self, price: Ints, *, priced: bool = False) -> Ints:
        """Return columns that count how often each edge is taken, -1 where there is none."""
        columns = np.full(price.shape, -1, dtype=np.int64)
        there = price >= 0
        costs = price[there] if priced and self.below is None else 0.0
        if priced and self.below is not None:
            costs = COUNT_WEIGHT
        columns[there] = self.milp.add_columns(int(there.sum()), cost=costs, upper=np.inf)
        if priced:
            self.prices.append((columns[there], price[there]))
        return columns

    def _conserve(self) -> None:
        """Every block leaves its start once and every node as often as it comes there; with a goal it ends at home."""
        places, moving = self.places, self.moving
        locations, table, start = len(places.locations), places.table, moving.start
        inside, occupied = places.inside, [(number, places.decks[number]) for number, _ in places.occupied()]
        move, fall, lifted, ride = self.move, self.fall, self.lifted, self.ride
        rows = self.milp.add_sums
        for block, origin in enumerate(moving.origin):
            waits = 1.0 if origin >= 0 else 0.0
            out = [move[block, start], lifted[block, locations], fall[block, locations:]]
            rows([(part.reshape(1, -1), 1.0) for part in out], lower=waits, upper=waits)
            came = [(move[block].T[:locations], 1.0), (lifted[block].T[:locations], 1.0)]
            went = [(part[block, :locations].reshape(locations, -1), -1.0) for part in (move, lifted, fall)]
            rows([*came, *went, (self.ends[block, :locations, None], -1.0)], lower=0, upper=0)
            on = np.zeros(len(places.decks))
            on[[number for number, deck in occupied if moving.blocks.held.get(block) == deck.carrier]] = -1.0
            came = [(move[block].T[inside], 1.0), (ride[block].T, 1.0)]
            went = [(move[block, inside], -1.0), (ride[block], -1.0), (self.ends[block, locations:, None], -1.0)]
            if len(on):
                rows([*came, *went], lower=on, upper=on)
            if block in moving.blocks.placed:
                lies = -1.0 if block in moving.blocks.lying else 0.0
                terms = [(fall[block].reshape(1, -1), 1.0), (move[block, table].reshape(1, -1), -1.0)]
                rows(terms, lower=lies, upper=lies)
                home = [move[block, :, moving.home], lifted[block, :, locations]]
                rows([(part.reshape(1, -1), 1.0) for part in home], lower=1, upper=1)
                rows([(self.ends[block].reshape(1, -1), 1.0)], upper=0)

    def _activations(self) -> None:
        """Blocks fall, ride and are lifted as often at most as there are topples, carries and lifts to take them."""
        places, moving, rows = self.places, self.moving, self.milp.add_sums
        locations = len(places.locations)
        for at in range(places.toppled):
            falling = []
            for block, origin in enumerate(moving.origin):
                sources = [at, locations] if origin == at else [at]
                falling.append(self.fall[block, sources])
                rows([(falling[-1][None], 1.0), (self.topple[None, [at]], -1.0)], upper=0)
            if self.cap is not None and falling:
                cap = -float(self.cap)
                rows([(np.concatenate(falling)[None], 1.0), (self.topple[None, [at]], cap)], upper=0)
        for source in range(locations if places.lifted else 0):
            openly = []
            for target in range(locations):
                taken = [self._lifted(block, source, target) for block in range(len(moving.blocks))]
                if source != target and taken:
                    self._paid(taken, self.lift[source, [target]])
            for block in range(len(moving.blocks)):
                openly.append(self._lifted(block, source, None))
            if openly:
                self._paid(openly, self.lift[source])

    def _lifted(self, block: int, source: int, target: int | None) -> Ints:
        """Return the columns by which lifts between two locations, or to any target, take a block."""
        moving, locations = self.moving, len(self.places.locations)
        sources = [source, locations] if moving.origin[block] == source else [source]
        if target is None:
            return self.lifted[block, sources].reshape(-1)
        targets = [target, locations] if moving.target[block] == target else [target]
        return self.lifted[block, sources][:, targets].reshape(-1)

    def _paid(self, taken: list[Ints], lifts: Ints) -> None:
        for columns in taken:
            self.milp.add_sums([(columns[None], 1.0), (lifts[None], -1.0)], upper=0)
        group = -float(self.places.lifted)
        self.milp.add_sums([(np.concatenate(taken)[None], 1.0), (lifts[None], group)], upper=0)

    def _carriers(self) -> None:
        """A carrier goes from station to station and stops at one; what ends on it fits it there."""
        places, rows = self.places, self.milp.add_sums
        decks, locations = places.decks, len(places.locations)
        if not decks:
            return
        stood = np.zeros(len(decks))
        stood[[number for number, _ in places.occupied()]] = -1.0
        rows([(self.carry.T, 1.0), (self.carry, -1.0), (self.stop[:, None], -1.0)], lower=stood, upper=stood)
        pairs = self.carry >= 0
        for block in range(len(self.moving.blocks)):
            rows([(self.ride[block][pairs][:, None], 1.0), (self.carry[pairs][:, None], -1.0)], upper=0)
            rows([(self.ends[block, locations:, None], 1.0), (self.stop[:, None], -1.0)], upper=0)
        for number, deck in enumerate(decks):
            room = -float(places.carriers[deck.carrier].capacity)
            rows([(self.ends[None, :, locations + number], 1.0), (self.stop[None, [number]], room)], upper=0)
            for other in np.flatnonzero(pairs[number]).tolist():
                riding, carried = self.ride[None, :, number, other], self.carry[number, [other]][None]
                rows([(riding, 1.0), (carried, room)], upper=0)

    def _counts(self) -> None:
        """What holds for some cheapest plan below a cost: how many topples and carries it may have.

        - Without a cap, a topple of a stack follows, since the last topple of that stack, an action that touches it
          (otherwise both are one, from the lower height); with a cap, a topple takes at least one block that stood
          there or was put there since.
        - A single carrier is loaded or unloaded between two carries and after the last one (otherwise two carries
          are one, which costs no more: distances are rounded by half a unit at most, and a carry costs 1 at least).
        """
        if self.below is None:
            return
        columns = np.concatenate([part for part, _ in self.prices])
        prices = np.concatenate([price for _, price in self.prices])
        self.milp.add_row(columns, prices, upper=self.below - 1)
        places, moving, rows = self.places, self.moving, self.milp.add_sums
        open_ended = [self.move[:, :, moving.gone].ravel(), self.forgotten]
        if moving.anywhere:
            open_ended.append(self.move[:, :, moving.home].ravel())
        group = -1.0 if self.cap is None else -float(max(1, places.lifted))
        for at in range(places.toppled):
            waiting = [block for block, origin in enumerate(moving.origin) if origin == at]
            arriving = [block for block, target in enumerate(moving.target) if target == at]
            touching = [self.move[:, at].ravel(), self.move[:, :, at].ravel(), *open_ended]
            touching += [self.move[waiting, moving.start].ravel(), self.move[arriving, :, moving.home].ravel()]
            lifts = [self.lift[at].ravel(), self.lift[:, at].ravel()]
            standing = len(self.start[places.locations[at]])
            first = min(1, standing) if self.cap is None else standing
            terms = [(self.topple[None, [at]], 1.0), *((part[None], -1.0) for part in touching)]
            rows([*terms, *((part[None], group) for part in lifts)], upper=first)
        if len(places.carriers) == 1:
            touching = [self.move[:, :, places.inside].ravel(), self.move[:, places.inside].ravel(), *open_ended]
            rows([(self.carry.reshape(1, -1), 1.0), *((part[None], -1.0) for part in touching)], upper=0)
