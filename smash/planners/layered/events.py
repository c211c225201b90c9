"""The layered model: the SMASH gadget with its free chain edges contracted.

It stands for the paper's sections "SMASH gadget" and "Computing a candidate task plan on the gadget".

A layer holds actions that do not touch each other. Gravity fixes the height of every block, so a chain of
height-indexed nodes shrinks to three nodes a block: its *start* place, *off* the stacks (on a buffer, or in the table
region after a topple), and its *goal* place. The edges between them are the gadget's: a cross-stack edge from
start to goal, cross-stack edges to and from a buffer, the topple edges into the table region, a table pick. A
stack takes part in one action a layer; a chain empties from its top and fills from its bottom. The buffers are one
node of unbounded capacity, which is a relaxation: in any plan, whatever happens between the first removal and the
last placement of a block costs at least what the model asks for it. `resting` adds the locations that there are.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smash.planners.layered.blocks import MovingBlocks
from smash.planners.milp.arrays import Floats, Ints, Milp, MilpBuilder
from smash.planners.milp.columns import taken
from smash.problem.problem import Problem

TRANSFER_COST = 2
TOPPLE_COST = 1
MOST_CIRCLES = 60
"""Up to so many blocks that may move directly, the circles of two and three of them are looked for."""
KINDS = ("direct", "aside", "fall", "from_aside", "from_table")
"""The edges of a block: start to goal, start to buffer, start to table (free), buffer to goal, table to goal."""


@dataclass(frozen=True, slots=True)
class LayeredModel:
    """The MILP and the meaning of its columns.

    `edges[kind]`: (moving blocks, layers) column indices, -1 where a block has no such edge in a layer.
    `topples`: per location the (cuts, layers) columns; cut c takes the leaving blocks from the c-th on.
    """

    milp: Milp
    edges: dict[str, Ints]
    topples: dict[str, Ints]


def build_layered(problem: Problem, blocks: MovingBlocks, horizon: int, deadline: float = math.inf) -> LayeredModel:
    """Build the layered model with unbounded buffers.

    Args:
        problem: what is planned.
        blocks: its moving blocks.
        horizon: number of layers.
        deadline: when to give up [s, clock of `perf_counter`].

    Raises:
        OutOfTime: where the deadline has passed.
    """
    return EventsBuilder(problem, blocks, horizon, deadline).build()


class EventsBuilder:
    """Builds the rows of `build_layered`, one method a constraint."""

    def __init__(self, problem: Problem, blocks: MovingBlocks, horizon: int, deadline: float) -> None:
        self.blocks = blocks
        self.cap = problem.options.max_topple
        self.horizon = horizon
        self.milp = MilpBuilder(deadline)
        self.edges = {kind: np.full((len(blocks), horizon), -1, dtype=np.int64) for kind in KINDS}
        self.topples: dict[str, Ints] = {}
        self.source = {block: at for at, pile in blocks.piles for block in pile}
        self.target = {block: at for at, chain in blocks.chains for block in chain}
        self.rank = {
            b: (number, rank) for number, (_, chain) in enumerate(blocks.chains) for rank, b in enumerate(chain)
        }

    def build(self) -> LayeredModel:
        """Add everything and return the model."""
        self._add_edges()
        self._add_states()
        self._add_topples()
        self._leave_and_arrive_once()
        self._return_after_leaving()
        for _, pile in self.blocks.piles:
            for lower, upper in itertools.pairwise(pile):
                self._leave_in_order(lower, upper)
        for _, chain in self.blocks.chains:
            for under, upper in itertools.pairwise(chain):
                self._arrive_in_order(under, upper)
        self._clear_before_filling()
        self._one_action_a_stack()
        self._detours()
        model = self.milp.build(self._name)
        return LayeredModel(model, self.edges, self.topples)

    def _add_edges(self) -> None:
        for block in range(len(self.blocks)):
            leaves = block not in self.blocks.lying
            arrives = block in self.blocks.placed
            at = self.source.get(block)
            if leaves and arrives and (at != self.target[block] or self.target[block] is None):
                self._add_edge("direct", block, TRANSFER_COST)
            if leaves:
                self._add_edge("aside", block, TRANSFER_COST)
                if at in self.blocks.toppled:
                    self._add_edge("fall", block, 0)
                if arrives:
                    self._add_edge("from_aside", block, TRANSFER_COST)
            if arrives and (not leaves or at in self.blocks.toppled):
                self._add_edge("from_table", block, TRANSFER_COST)

    def _add_edge(self, kind: str, block: int, cost: float) -> None:
        self.edges[kind][block] = self.milp.add_columns(self.horizon, cost=cost)

    def _add_states(self) -> None:
        """Columns for what a block has done by the end of a layer: each the last one plus what happens in the layer."""
        leaving = [block for block in range(len(self.blocks)) if block not in self.blocks.lying]
        self.left = self._sums(leaving, {"direct": 1, "aside": 1, "fall": 1})
        self.arrived = self._sums(sorted(self.blocks.placed), {"direct": 1, "from_aside": 1, "from_table": 1})
        self.rests = self._sums(leaving, {"aside": 1, "from_aside": -1})
        self.lies = self._sums(leaving, {"fall": 1, "from_table": -1})

    def _sums(self, blocks: list[int], signs: dict[str, int]) -> Ints:
        """Return columns (blocks, layers): the signed sum of edges up to a layer, between 0 and 1."""
        sums = np.full((len(self.blocks), self.horizon), -1, dtype=np.int64)
        for block in blocks:
            sums[block] = self.milp.add_columns(self.horizon, integral=False)
            for layer in range(self.horizon):
                before = [sums[block, layer - 1]] if layer else []
                parts = [
                    (self.edges[k][block, layer], -v) for k, v in signs.items() if self.edges[k][block, layer] >= 0
                ]
                columns = [sums[block, layer], *before, *(column for column, _ in parts)]
                values = [1, *[-1] * len(before), *(value for _, value in parts)]
                self.milp.add_row(columns, values, lower=0, upper=0)
        return sums

    def _add_topples(self) -> None:
        """Without a cap the whole leaving part falls: what lies on the table is as near as what lies on a stack."""
        for location, pile in self.blocks.piles:
            if location not in self.blocks.toppled:
                continue
            cuts = len(pile) if self.cap is not None else 1
            columns = self.milp.add_columns(cuts * self.horizon, cost=TOPPLE_COST).reshape(cuts, self.horizon)
            self.topples[location] = columns
            for layer in range(self.horizon):
                self._topple_rows(pile, columns[:, layer], layer)

    def _topple_rows(self, pile: tuple[int, ...], cuts: Ints, layer: int) -> None:
        falling = self.edges["fall"][list(pile), layer]
        for position, block in enumerate(pile):
            below = cuts[: position + 1]
            self.milp.add_row([falling[position], *below], [1, *[-1] * len(below)], upper=0)
            if position < len(cuts):  # what lies from the cut on has left by the end of the layer
                gone = self._left(block, layer)
                self.milp.add_row([*gone, cuts[position]], [*[1] * len(gone), -1], lower=0)
        if self.cap is not None:
            self.milp.add_row([*falling, *cuts], [*[1] * len(falling), *[-self.cap] * len(cuts)], upper=0)

    def _columns(self, kinds: tuple[str, ...], block: int, layers: slice) -> list[int]:
        found = np.concatenate([self.edges[kind][block, layers] for kind in kinds])
        return [int(column) for column in found if column >= 0]

    def _left(self, block: int, layer: int) -> list[int]:
        """The column that is 1 where `block` has left its start place by the end of `layer`."""
        return [int(self.left[block, layer])]

    def _arrived(self, block: int, layer: int) -> list[int]:
        """The column that is 1 where `block` has reached its goal place by the end of `layer`."""
        return [int(self.arrived[block, layer])]

    def _leave_and_arrive_once(self) -> None:
        last = self.horizon - 1
        for block in range(len(self.blocks)):
            if block not in self.blocks.lying:
                columns = self._left(block, last)
                self.milp.add_row(columns, [1] * len(columns), lower=1, upper=1)
            if block in self.blocks.placed:
                columns = self._arrived(block, last)
                self.milp.add_row(columns, [1] * len(columns), lower=1, upper=1)

    def _return_after_leaving(self) -> None:
        """What comes back in a layer was off the stacks at the end of the layer before."""
        for block in sorted(self.blocks.placed - self.blocks.lying):
            for away, kind in ((self.rests, "from_aside"), (self.lies, "from_table")):
                for layer in range(self.horizon):
                    came = self._columns((kind,), block, slice(layer, layer + 1))
                    there = [int(away[block, layer - 1])] if layer else []
                    if came:
                        self.milp.add_row([*came, *there], [1, *[-1] * len(there)], upper=0)

    def _leave_in_order(self, lower: int, upper: int) -> None:
        """A pop needs all above gone in an earlier layer; a topple takes what is above with it."""
        for layer in range(self.horizon):
            gone = self._left(lower, layer)
            falling = [int(c) for c in self.edges["fall"][[lower], layer] if c >= 0]
            before = self._left(upper, layer - 1) if layer else []
            values = [*[1] * len(gone), *[-1] * len(falling), *[-1] * len(before)]
            self.milp.add_row([*gone, *falling, *before], values, upper=0)
            if falling:
                above = self._left(upper, layer)
                self.milp.add_row([*gone, *above], [*[1] * len(gone), *[-1] * len(above)], upper=0)

    def _arrive_in_order(self, under: int, upper: int) -> None:
        for layer in range(self.horizon):
            there = self._arrived(upper, layer)
            before = self._arrived(under, layer - 1) if layer else []
            self.milp.add_row([*there, *before], [*[1] * len(there), *[-1] * len(before)], upper=0)

    def _clear_before_filling(self) -> None:
        lowest = {at: pile[0] for at, pile in self.blocks.piles}
        for location, chain in self.blocks.chains:
            if location is None or location not in lowest:
                continue
            for layer in range(self.horizon):
                there = self._arrived(chain[0], layer)
                gone = self._left(lowest[location], layer - 1) if layer else []
                self.milp.add_row([*there, *gone], [*[1] * len(there), *[-1] * len(gone)], upper=0)

    def _one_action_a_stack(self) -> None:
        filled = {at: chain for at, chain in self.blocks.chains if at is not None}
        emptied = dict(self.blocks.piles)
        for location in sorted({*filled, *emptied}):
            for layer in range(self.horizon):
                columns = self._actions_on(location, filled.get(location, ()), emptied.get(location, ()), layer)
                self.milp.add_row(columns, [1] * len(columns), upper=1)

    def _actions_on(self, location: str, filled: Sequence[int], emptied: Sequence[int], layer: int) -> list[int]:
        """Columns of what takes start blocks from `location`, topples it, or adds to its goal chain in a layer."""
        now = slice(layer, layer + 1)
        columns = [c for block in emptied for c in self._columns(("direct", "aside"), block, now)]
        columns += [c for b in filled for c in self._columns(("direct", "from_aside", "from_table"), b, now)]
        if location in self.topples:
            columns += [int(column) for column in self.topples[location][:, layer]]
        return columns

    def _detours(self) -> None:
        """Valid inequalities: of blocks that wait for each other in a circle, not all move directly.

        `a` waits for `b` where a direct move of `b` must come before one of `a`.
        """
        direct = [b for b in range(len(self.blocks)) if self.edges["direct"][b, 0] >= 0]
        if len(direct) > MOST_CIRCLES:
            return
        before = {a: {b for b in direct if b != a and self._comes_before(a, b)} for a in direct}
        for a in direct:
            for b in before[a]:
                if a < b and a in before[b]:
                    self._not_all_direct((a, b))
                for c in before[b]:
                    circle = a in before.get(c, ()) and a < b and a < c
                    if circle and a not in before[b] and b not in before[c] and c not in before[a]:
                        self._not_all_direct((a, b, c))

    def _comes_before(self, a: int, b: int) -> bool:
        """Whether a direct move of `a` must come before a direct move of `b`."""
        if self.source[a] == self.target[b]:
            return True
        if self.source[a] == self.source[b] and a > b:
            return True
        (chain_a, rank_a), (chain_b, rank_b) = self.rank[a], self.rank[b]
        return chain_a == chain_b and rank_a < rank_b

    def _not_all_direct(self, blocks: tuple[int, ...]) -> None:
        columns = [c for block in blocks for c in self._columns(("direct",), block, slice(None))]
        self.milp.add_row(columns, [1] * len(columns), upper=len(blocks) - 1)

    def _name(self, column: int) -> str:
        for kind, columns in self.edges.items():
            found = np.argwhere(columns == column)
            if len(found):
                block, layer = found[0]
                return f"{kind}_block{block}_layer{layer + 1}"
        for number, columns in enumerate(self.topples.values()):
            found = np.argwhere(columns == column)
            if len(found):
                cut, layer = found[0]
                return f"topple_stack{number}_cut{cut}_layer{layer + 1}"
        return f"x{column}"


@dataclass(frozen=True, slots=True)
class Event:
    """One edge that a solution takes: `layer`, the kind of the edge (or `topple`), its block or its cut.

    `location` is that of a topple, or where a block is put aside if the model says so.
    """

    layer: int
    kind: str
    subject: int
    location: str | None = None


def read_events(model: LayeredModel, vector: Floats) -> list[Event]:
    """Return the edges that a solution takes, by layer; within one, what frees room before what takes it."""
    events = []
    for kind, columns in model.edges.items():
        if kind != "fall":
            events += [Event(layer, kind, block) for block, layer in taken(columns, vector)]
    for location, cuts in model.topples.items():
        events += [Event(layer, "topple", cut, location) for cut, layer in taken(cuts, vector)]
    order = {"from_aside": 0, "topple": 1, "from_table": 2, "direct": 3, "aside": 4}
    return sorted(events, key=lambda event: (event.layer, order[event.kind]))
