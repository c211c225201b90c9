"""The layered model with every resting place in it: for the instances whose detours the three-node model cannot hold.

Where few buffers make blocks rest on stacks, on each other, or move more than twice, the positions of the
chains come back: a binary for each moving block, location, height and layer. Gravity anchors the heights; a stack
takes part in one action a layer, so that a removal or a placement below a top is ruled out by gravity alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from smash.planners.layered.events import TOPPLE_COST, TRANSFER_COST
from smash.planners.milp.arrays import Floats, Ints, Milp, MilpBuilder
from smash.problem.actions.topple import Topple
from smash.problem.model import TABLE, Action, Instance, OnGoal, Pick, Place, PlanOptions, State
from smash.problem.views.demands import Demands


@dataclass(frozen=True, slots=True)
class PositionsModel:
    """The MILP and the meaning of its columns.

    Axes: b moving blocks, l locations, h heights above the kept blocks, t layers. `enter`, `leave`, `fall`:
    (b, l, h, t) a block comes to, is taken from, or falls from a place in a layer; `take`: (b, t) it is taken from
    the table region; `topple`: (l, h, t) the cut of a topple. -1 where there is no such column.
    """

    blocks: tuple[str, ...]
    keep: tuple[int, ...]
    milp: Milp
    enter: Ints
    leave: Ints
    fall: Ints
    take: Ints
    topple: Ints


def build_positions(
    instance: Instance,
    demands: Demands,
    options: PlanOptions,
    horizon: int,
    lower_bound: int,
    upper_bound: int | None,
    deadline: float = math.inf,
) -> PositionsModel:
    """Build the model.

    Args:
        instance: the problem.
        demands: what its goal asks; kept blocks are left out, but for an `on` goal, whose towers may have to move.
        options: topple or not, and its cap.
        horizon: number of layers.
        lower_bound: a proven bound on the cost of every plan, as a row.
        upper_bound: only plans cheaper than this are of interest (None: all are).
        deadline: when to give up [s, clock of `perf_counter`].

    Raises:
        OutOfTime: where the deadline has passed.
    """
    return _Builder(instance, demands, options, horizon, deadline).build(lower_bound, upper_bound)


class _Builder:
    def __init__(
        self, instance: Instance, demands: Demands, options: PlanOptions, horizon: int, deadline: float
    ) -> None:
        self.instance = instance
        self.options = options
        self.horizon = horizon
        everything = isinstance(instance.goal, OnGoal)
        self.keep = tuple(0 if everything else demands.keep[at] for at in instance.locations)
        standing = [b for at, k in zip(instance.locations, self.keep, strict=True) for b in instance.start[at][k:]]
        lying = [b for b in instance.table if everything or b in demands.placed]
        self.blocks = tuple(standing + lying)
        self.number = {block: index for index, block in enumerate(self.blocks)}
        self.lying = [self.number[block] for block in lying]
        self.demands = demands
        self.milp = MilpBuilder(deadline)

    def build(self, lower_bound: int, upper_bound: int | None) -> PositionsModel:
        n, places, layers = len(self.blocks), len(self.instance.locations), self.horizon
        toppled = len(self.instance.stacks) if self.options.topple else 0
        shape = (n, places, n, layers)
        self.at = self._columns((n, places, n, layers + 1))
        self.enter = self._columns(shape, cost=TRANSFER_COST)
        self.leave = self._columns(shape)
        self.fall = np.full(shape, -1, dtype=np.int64)
        self.fall[:, :toppled] = self._columns((n, toppled, n, layers))
        self.take = np.full((n, layers), -1, dtype=np.int64)
        self.lies = np.full((n, layers + 1), -1, dtype=np.int64)
        if toppled or self.lying:
            self.take = self._columns((n, layers))
            self.lies = self._columns((n, layers + 1))
        self.topple = np.full((places, n, layers), -1, dtype=np.int64)
        self.topple[:toppled] = self._columns((toppled, n, layers), cost=TOPPLE_COST)
        self._start()
        self._flow()
        self._gravity()
        self._topples()
        self._one_action_a_stack()
        self._goal()
        self._no_idle_layers()
        self._cost(lower_bound, upper_bound)
        return PositionsModel(
            self.blocks, self.keep, self.milp.build(), self.enter, self.leave, self.fall, self.take, self.topple
        )

    def _columns(self, shape: tuple[int, ...], cost: float = 0.0) -> Ints:
        return self.milp.add_columns(int(np.prod(shape)), cost=cost).reshape(shape)

    def _fix(self, columns: Ints, value: float) -> None:
        self.milp.add_sums([(columns.reshape(-1, 1), 1.0)], lower=value, upper=value)

    def _start(self) -> None:
        standing = np.zeros(self.at.shape[:3], dtype=bool)
        for place, location in enumerate(self.instance.locations):
            for height, block in enumerate(self.instance.start[location][self.keep[place] :]):
                standing[self.number[block], place, height] = True
        self._fix(self.at[..., 0][standing], 1)
        self._fix(self.at[..., 0][~standing], 0)
        if (self.lies >= 0).all() and len(self.blocks):
            lying = np.zeros(len(self.blocks), dtype=bool)
            lying[self.lying] = True
            self._fix(self.lies[~lying, 0], 0)
            self._fix(self.lies[lying, 0], 1)

    def _flow(self) -> None:
        """Conservation at every place and at the table node; what is taken up in a layer is put down in it."""
        cells = self.enter.size
        now, before = self.at[..., 1:].reshape(cells, 1), self.at[..., :-1].reshape(cells, 1)
        enter, leave, fall = (a.reshape(cells, 1) for a in (self.enter, self.leave, self.fall))
        self.milp.add_sums([(now, 1), (before, -1), (enter, -1), (leave, 1), (fall, 1)], lower=0, upper=0)
        n, layers = len(self.blocks), self.horizon
        by_block = [np.moveaxis(a, 3, 1).reshape(n * layers, -1) for a in (self.enter, self.leave, self.fall)]
        take = self.take.reshape(n * layers, 1)
        self.milp.add_sums([(by_block[0], 1), (by_block[1], -1), (take, -1)], lower=0, upper=0)
        if (self.lies >= 0).all():
            now, before = self.lies[:, 1:].reshape(-1, 1), self.lies[:, :-1].reshape(-1, 1)
            self.milp.add_sums([(now, 1), (before, -1), (by_block[2], -1), (take, 1)], lower=0, upper=0)

    def _gravity(self) -> None:
        """At most one block a place, and one only where the place below holds one."""
        places = np.moveaxis(self.at, 0, 3)  # l, h, t, b
        n = len(self.blocks)
        self.milp.add_sums([(places.reshape(-1, n), 1)], upper=1)
        upper, under = places[:, 1:].reshape(-1, n), places[:, :-1].reshape(-1, n)
        if len(upper):
            self.milp.add_sums([(upper, 1), (under, -1)], upper=0)

    def _topples(self) -> None:
        toppled = len(self.instance.stacks) if self.options.topple else 0
        n = len(self.blocks)
        for place in range(toppled):
            for height in range(n):
                falls = np.moveaxis(self.fall[:, place, height], 0, 1)  # t, b
                cuts = np.moveaxis(self.topple[place, : height + 1], 0, 1)  # t, cuts
                self.milp.add_sums([(falls, 1), (cuts, -1)], upper=0)
                after = np.moveaxis(self.at[:, place, height, 1:], 0, 1)
                self.milp.add_sums([(after, 1), (self.topple[place, height][:, None], 1)], upper=1)
            cap = self.options.max_topple
            if cap is not None:
                falls = np.moveaxis(self.fall[:, place], 2, 0)
                cuts = np.moveaxis(self.topple[place], 1, 0)
                self.milp.add_sums([(falls, 1), (cuts, -cap)], upper=0)

    def _one_action_a_stack(self) -> None:
        enter, leave = (np.moveaxis(a, (1, 3), (0, 1)) for a in (self.enter, self.leave))
        places, layers = enter.shape[:2]
        rows = places * layers
        cuts = np.moveaxis(self.topple, 2, 1).reshape(rows, -1)
        self.milp.add_sums([(enter.reshape(rows, -1), 1), (leave.reshape(rows, -1), 1), (cuts, 1)], upper=1)

    def _goal(self) -> None:
        last = self.at[..., -1]
        goal = self.instance.goal
        if isinstance(goal, OnGoal):
            for upper, under in goal.on.items():
                a, b = last[self.number[upper]], last[self.number[under]]
                self.milp.add_sums([(a[:, 1:].reshape(1, -1), 1)], lower=1)
                self.milp.add_sums([(a[:, 1:].reshape(-1, 1), 1), (b[:, :-1].reshape(-1, 1), -1)], upper=0)
            for block in goal.bottom:
                self.milp.add_sums([(last[self.number[block], :, :1].reshape(1, -1), 1)], lower=1)
            return
        for place, location in enumerate(self.instance.locations):
            for height, block in enumerate(self.demands.build.get(location, ())):
                self._fix(last[self.number[block], place, height], 1)

    def _no_idle_layers(self) -> None:
        """Symmetry: a layer in which nothing happens is followed by such layers only."""
        enter = np.moveaxis(self.enter, 3, 0).reshape(self.horizon, -1)
        cuts = np.moveaxis(self.topple, 2, 0).reshape(self.horizon, -1)
        most = len(self.instance.locations)
        if self.horizon > 1:
            later, sooner = slice(1, None), slice(None, -1)
            self.milp.add_sums(
                [(enter[later], 1), (cuts[later], 1), (enter[sooner], -most), (cuts[sooner], -most)], upper=0
            )

    def _cost(self, lower_bound: int, upper_bound: int | None) -> None:
        upper = np.inf if upper_bound is None else upper_bound - 1
        enter, cuts = self.enter.reshape(1, -1), self.topple.reshape(1, -1)
        self.milp.add_sums([(enter, TRANSFER_COST), (cuts, TOPPLE_COST)], lower=lower_bound, upper=upper)


def read_positions(instance: Instance, model: PositionsModel, vector: Floats) -> tuple[Action, ...] | None:
    """Return the plan of a solution: layers in order, one layer's actions in any order, for none touches another."""
    state = State.start_of(instance)
    plan: list[Action] = []
    layers = model.take.shape[1]
    enter, leave, take = (_taken(columns, vector) for columns in (model.enter, model.leave, model.take))
    cuts = _taken(model.topple, vector)
    for layer in range(layers):
        for place, height in np.argwhere(cuts[:, :, layer]):
            location = instance.locations[place]
            cut = model.keep[place] + int(height)
            if len(state.piles[location]) > cut:
                plan.append(Topple(location, cut + 1))
                state.table.update(state.piles[location][cut:])
                del state.piles[location][cut:]
        for block, place, _ in np.argwhere(enter[..., layer]):
            name, target = model.blocks[block], instance.locations[place]
            if take[block, layer]:
                source = TABLE
                state.table.discard(name)
            else:
                found = np.argwhere(leave[block, ..., layer])
                if not len(found):
                    return None
                source = instance.locations[found[0][0]]
                state.piles[source].remove(name)
            state.piles[target].append(name)
            plan += [Pick(name, source), Place(name, target)]
    return tuple(plan)


def _taken(columns: Ints, vector: Floats) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    return (columns >= 0) & (vector[columns] > 0.5)
