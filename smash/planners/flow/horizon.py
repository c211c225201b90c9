"""How many steps a plan of a given cost can need on the gadget: what makes a horizon sound."""

from __future__ import annotations

from dataclasses import dataclass

from smash.planners.flow.scope import Scope, goal_positions
from smash.problem.model import OnGoal, PlanOptions, StacksGoal


@dataclass(frozen=True)
class StepBound:
    """Bounds the steps of every plan of a given cost, in the form that `encode` gives it and `scope` keeps.

    One after the other, a transfer takes one step and a topple of k blocks k + 2 (staging, the topple, and the
    move to v_T^i). Before the first one the piles rise by at most `rise`, after the last one they sink by at
    most `sink`.

    Attributes:
        rise: steps before the first move.
        sink: steps after the last one.
        moves: transfers that any plan needs (each block whose position is wrong moves at least once).
        falls: blocks that topples can bring down in all, each at most once.
        again: whether a block may have to fall again after each of its transfers.
        returns: whether each fallen block must be brought back.
        cap: most blocks of one topple.
        waiting: blocks that start on the table.
        topple: whether topple is allowed.
    """

    rise: int
    sink: int
    moves: int
    falls: int
    again: bool
    returns: bool
    cap: int
    waiting: int
    topple: bool

    def steps(self, cost: int) -> int:
        """Return a number of steps in which every plan of at most `cost` actions can be carried out."""
        most = 0
        for topples in range(cost + 1 if self.topple else 1):
            transfers = (cost - topples) // 2
            falls = min(self.falls + (transfers if self.again else 0), self.cap * topples)
            if self.returns:
                falls = min(falls, transfers - self.waiting)
            if transfers >= self.moves and falls >= topples:
                most = max(most, transfers + falls + 2 * topples)
        return self.rise + most + self.sink

    def fitting_cost(self, steps: int, most: int) -> int:
        """Return the largest cost up to `most` whose plans all fit into `steps`; -1: not even cost 0."""
        cost = -1
        while cost < most and self.steps(cost + 1) <= steps:
            cost += 1
        return cost


def step_bound(scope: Scope, options: PlanOptions) -> StepBound:
    """Return the bound for a scope."""
    instance, height = scope.instance, scope.gadget.height
    goal = goal_positions(instance)
    moving = {instance.blocks[number] for number in scope.moving}
    piles = [len(pile) for pile in instance.start.values() if pile]
    tops: dict[str, int] = {}
    for location, level in goal.values():
        tops[location] = max(level, tops.get(location, 0))
    return StepBound(
        rise=max([height - size for size in piles] + [1] * bool(instance.table), default=0),
        sink=height - min(tops.values(), default=1),
        moves=len(moving & goal.keys()),
        falls=sum(block in moving for stack in instance.stacks for block in instance.start[stack]),
        again=isinstance(instance.goal, OnGoal),
        returns=isinstance(instance.goal, StacksGoal),
        cap=height if options.max_topple is None else min(height, options.max_topple),
        waiting=len(instance.table),
        topple=options.topple,
    )
