"""How many steps a plan of a given cost can need on the gadget: what makes a horizon sound."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from smash.gadget import Gadget
from smash.planners.flow.scope import Scope, goal_positions
from smash.problem.model import StacksGoal
from smash.problem.problem import Problem

FREE = 1 << 40
"""The cost of an action that there is not."""


@dataclass(frozen=True)
class Prices:
    """The least cost of an action of each form; `FREE` where there is none.

    Attributes:
        transfer: a pick and a place between two places.
        staged: an activation that pebbles are staged for (a topple).
        token: an activation that moves a token (a carry).
        in_place: an activation that moves the top of a pile (a lift).
    """

    transfer: int
    staged: int
    token: int
    in_place: int

    @classmethod
    def of(cls, gadget: Gadget) -> Prices:
        """Return the least costs on a gadget."""

        def least(costs: Iterable[int]) -> int:
            return min(costs, default=FREE)

        aggregates = gadget.aggregates
        return cls(
            transfer=least(edge.cost for edge in gadget.edges if edge.kind.picks),
            staged=least(each.cost for each in aggregates if each.locks is not None),
            token=least(each.cost for each in aggregates if each.token is not None),
            in_place=least(each.cost for each in aggregates if each.in_place),
        )


@dataclass(frozen=True)
class StepBound:
    """Bounds the steps of every plan of a given cost, in the form that `encode` gives it and `scope` keeps.

    One after the other, a transfer or a carry takes one step, a topple of k blocks k + 2 (staging, the topple, and
    the move to v_T^i), a lift of at most k blocks 2 k - 1 (the target's pile sinks by k - 1 before, the source's
    rises by as much after). Before the first one the piles rise by at most `rise`, after the last one they sink by at
    most `sink`.

    Attributes:
        prices: least costs.
        rise: steps before the first move.
        sink: steps after the last one.
        moves: blocks that enter a pile in any plan (each block whose position is wrong).
        falls: blocks that topples can bring down in all, each at most once, those of buffers put on a stack first.
        again: whether a block may have to fall again after each of its transfers.
        returns: whether each fallen block must be brought back, by a transfer each.
        cap: most blocks of one topple.
        waiting: blocks that start on the table.
        lifted: most blocks of one lift; 0 where there is none.
    """

    prices: Prices
    rise: int
    sink: int
    moves: int
    falls: int
    again: bool
    returns: bool
    cap: int
    waiting: int
    lifted: int

    @property
    def least_cost(self) -> int:
        """A lower bound on the cost of every plan: that of bringing in `moves` blocks."""
        price = self.prices
        counts = range(-(-self.moves // self.lifted) + 1 if self.lifted else 1)
        costs = (lifts * price.in_place + max(0, self.moves - lifts * self.lifted) * price.transfer for lifts in counts)
        least = min(costs)
        return least if least < FREE else 0

    def steps(self, cost: int) -> int:
        """Return a number of steps in which every plan of at most `cost` can be carried out."""
        price = self.prices
        transfers = np.arange(cost // price.transfer + 1)[:, None]
        most_topples = min(cost // price.staged, self.falls + (len(transfers) if self.again else 0))
        topples = np.arange(most_topples + 1)[None, :]
        left = cost - transfers * price.transfer - topples * price.staged
        falls = np.minimum(self.falls + (transfers if self.again else 0), self.cap * topples)
        if self.returns:
            falls = np.minimum(falls, transfers - self.waiting)
        spare = np.maximum(left, 0)
        lifts = spare // price.in_place
        others = (2 * self.lifted - 1) * lifts if self.lifted else np.zeros_like(spare)
        if price.token < FREE:  # kinds that share what is left: it buys no more steps than by the better one alone
            most = (2 * self.lifted - 1) * spare // price.in_place if self.lifted else others
            others = np.maximum(most, spare // price.token)
        possible = (left >= 0) & (transfers + lifts * self.lifted >= self.moves) & (falls >= topples)
        steps = np.where(possible, transfers + falls + 2 * topples + others, 0)
        return int(self.rise + steps.max() + self.sink)

    def fitting_cost(self, steps: int, most: int) -> int:
        """Return the largest cost up to `most` whose plans all fit into `steps`; -1: not even cost 0."""
        low, high = -1, most
        while low < high:
            middle = (low + high + 1) // 2
            low, high = (middle, high) if self.steps(middle) <= steps else (low, middle - 1)
        return low


def step_bound(problem: Problem, scope: Scope) -> StepBound:
    """Return the bound for a problem and its scope."""
    instance, gadget, cap = scope.instance, scope.gadget, problem.options.max_topple
    height = gadget.height
    goal = goal_positions(instance)
    moving = {instance.blocks[number] for number in scope.moving}
    piles = [len(pile) for pile in instance.start.values() if pile]
    tops: dict[str, int] = {}
    for location, level in goal.values():
        tops[location] = max(level, tops.get(location, 0))
    lifted = max((each.capacity for each in gadget.aggregates if each.in_place), default=0)
    return StepBound(
        prices=Prices.of(gadget),
        rise=max([height - size for size in piles] + [1] * bool(instance.table), default=0),
        sink=height - min(tops.values(), default=1),
        moves=len(moving & goal.keys()),
        falls=len(moving) - len(instance.table),
        again=not scope.direct,
        returns=isinstance(instance.goal, StacksGoal),
        cap=height if cap is None else min(height, cap),
        waiting=len(instance.table),
        lifted=lifted,
    )
