"""The paper's time-expanded multi-commodity flow on a gadget, as a MILP ("Computing a candidate task plan").

Column x_j is 1 where pebble k takes arc j of the time-expanded graph; the tokens (carriers) are pebbles too. Beside
the x there is, per aggregate and step, a_{s,t} = 1 where it is active, as TOPPLE node v_{T_s} (its cost is paid here,
once), per aggregate that stages pebbles and layer, h_{s,t} = 1 where its gathering node holds one, and, per buffer
that is like others and step, b_{u,t} = 1 where it has been used (`_buffers_in_order`). The other rows are those of
DESIGN's "what one step may hold"; the same rules are in words in `smash.gadget.motion.motion_fault`. Nothing
here knows which aggregating actions the gadget has.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from smash.gadget import Aggregate, EdgeKind, NodeKind
from smash.gadget.motion import PebbleMotion
from smash.planners.flow.arcs import WAIT, Arcs, arcs_of
from smash.planners.flow.reach import Reach
from smash.planners.flow.scope import Scope
from smash.planners.milp.arrays import Floats, Ints, Milp, MilpBuilder
from smash.problem.model import OnGoal


@dataclass(frozen=True)
class FlowModel:
    """A built model and what is needed to read its solutions.

    Attributes:
        scope: pebbles and gadget.
        arcs: the first columns of the model, in order.
        milp: the model.
        active: first column of a_{s,t}, by (aggregate, step); shape (aggregates, T).
        holds: column of h_{s,t}, by (staging aggregate, layer); shape (staging aggregates, T + 1).
        used: column of b_{u,t}, by (buffer of `Scope.alike`, step); shape (buffers, T).
    """

    scope: Scope
    arcs: Arcs
    milp: Milp
    active: Ints
    holds: Ints
    used: Ints

    def motion(self, vector: Floats) -> PebbleMotion:
        """Read the pebble motion off a solution; an activation that moves nothing is dropped."""
        scope, arcs = self.scope, self.arcs
        layers = np.tile(np.array(scope.start, dtype=np.int64), (arcs.horizon + 1, 1))
        used = np.flatnonzero(vector[: len(arcs)] > 0.5)
        layers[arcs.step[used] + 1, arcs.pebble[used]] = arcs.head[used]
        active: list[int | None] = [None] * arcs.horizon
        for edge, step in zip(arcs.edge[used].tolist(), arcs.step[used].tolist(), strict=True):
            if edge in scope.gadget.activations:
                active[step] = scope.gadget.activations[edge]
        return PebbleMotion(scope.gadget, scope.instance.blocks, tuple(map(tuple, layers.tolist())), tuple(active))

    def vector(self, motion: PebbleMotion) -> Floats | None:
        """Return the solution that stands for a motion, or None where it takes an arc that the model lacks."""
        arcs, gadget = self.arcs, self.scope.gadget
        if motion.steps > arcs.horizon:
            return None
        motion = motion.padded(arcs.horizon)
        layers = np.array(motion.layers, dtype=np.int64)
        taken = np.full((arcs.horizon, layers.shape[1]), WAIT, dtype=np.int64)
        for step in range(arcs.horizon):
            for move in motion.moves(step):
                taken[step, move.pebble] = move.edge
        vector = np.zeros(self.milp.columns)
        vector[: len(arcs)] = (layers[arcs.step, arcs.pebble] == arcs.tail) & (
            taken[arcs.step, arcs.pebble] == arcs.edge
        )
        for step, number in enumerate(motion.active):
            if number is not None:
                vector[self.active[number, step]] = 1
        for index, number in enumerate(gadget.staging):
            vector[self.holds[index]] = (layers == gadget.aggregates[number].gather).any(axis=1)
        for buffer, used in zip(self.scope.alike, self.used, strict=True):
            entered = (layers == gadget.top(buffer)).any(axis=1)
            vector[used] = np.logical_or.accumulate(entered)[1:]
        return vector if self.milp.violation(vector) < 1e-6 else None


def build(scope: Scope, reaches: dict[int, Reach], horizon: int) -> FlowModel:
    """Build the model of a scope for a horizon of T steps."""
    return _Assembly(scope, arcs_of(scope, reaches, horizon)).model()


class _Assembly:
    """Adds the columns and the rows, one kind of row a method."""

    def __init__(self, scope: Scope, arcs: Arcs) -> None:
        self.scope, self.arcs, self.gadget = scope, arcs, scope.gadget
        self.builder = MilpBuilder()
        aggregates, staging, horizon = len(self.gadget.aggregates), len(self.gadget.staging), arcs.horizon
        is_activation = np.zeros(len(self.gadget.edges) + 1, dtype=bool)
        is_activation[list(self.gadget.activations)] = True
        costs = np.array([*(edge.cost for edge in self.gadget.edges), 0], dtype=float)
        self.columns = self.builder.add_columns(len(arcs), cost=np.where(is_activation, 0, costs)[arcs.edge])
        prices = [aggregate.cost for aggregate in self.gadget.aggregates]
        active = self.builder.add_columns(aggregates * horizon, cost=np.repeat(np.array(prices, dtype=float), horizon))
        holds = self.builder.add_columns(staging * (horizon + 1))
        self.active, self.holds = active.reshape(aggregates, horizon), holds.reshape(staging, horizon + 1)
        alike = len(scope.alike)
        self.used = self.builder.add_columns(alike * horizon).reshape(alike, horizon)
        self._by_edge = np.argsort(arcs.edge, kind="stable")
        self._edges = arcs.edge[self._by_edge]

    def model(self) -> FlowModel:
        self._conservation()
        self._node_capacities()
        self._swaps()
        self._locations()
        for number, aggregate in enumerate(self.gadget.aggregates):
            if aggregate.locks is not None:
                self._gathering(aggregate, self.holds[self.gadget.staging.index(number)])
            if aggregate.in_place:
                self._rungs(aggregate, self.active[number])
            else:
                self._activation(aggregate, self.active[number])
            if aggregate.locks is not None:
                self._emptied(self.active[number], self.holds[self.gadget.staging.index(number)])
        self._one_activation()
        self._tokens()
        self._arrivals()
        self._on_relations()
        self._buffers_in_order()
        milp = self.builder.build(self._name)
        return FlowModel(self.scope, self.arcs, milp, self.active, self.holds, self.used)

    def _grouped(self, keys: Ints, columns: Ints, values: Floats | float, least: int = 1, **sides: float) -> None:
        """Add one row per distinct key, over the columns that have it; rows of fewer than `least` entries fall away."""
        if not len(keys):
            return
        _, row, count = np.unique(keys, return_inverse=True, return_counts=True)
        keep = count[row] >= least
        renumber = np.cumsum(count >= least) - 1
        entries = np.broadcast_to(np.asarray(values, dtype=float), keys.shape)
        self.builder.add_rows(
            renumber[row[keep]], columns[keep], entries[keep], count=int((count >= least).sum()), **sides
        )

    def _key(self, node: Ints, layer: Ints) -> Ints:
        return node * (self.arcs.horizon + 2) + layer

    def _conservation(self) -> None:
        """Each pebble leaves its start, and leaves every node between as often as it enters it."""
        arcs, nodes = self.arcs, len(self.gadget.nodes)
        starts = arcs.step == 0
        for pebble in self.scope.pebbles:
            mine = starts & (arcs.pebble == pebble)
            self.builder.add_row(self.columns[mine], 1.0, lower=1, upper=1)
        out, into = np.flatnonzero(arcs.step > 0), np.flatnonzero(arcs.step < arcs.horizon - 1)
        keys = np.concatenate(
            [
                self._key(arcs.pebble[out] * nodes + arcs.tail[out], arcs.step[out]),
                self._key(arcs.pebble[into] * nodes + arcs.head[into], arcs.step[into] + 1),
            ]
        )
        values = np.concatenate([np.ones(len(out)), -np.ones(len(into))])
        self._grouped(keys, np.concatenate([out, into]), values, lower=0, upper=0)

    def _node_capacities(self) -> None:
        """No node holds more pebbles than its capacity, tokens apart."""
        arcs = self.arcs
        capacity = np.array([node.capacity for node in self.gadget.nodes], dtype=np.int64)
        for limit in np.unique(capacity[capacity < len(self.scope.moving)]):
            here = np.flatnonzero((capacity[arcs.head] == limit) & (arcs.pebble < self.scope.blocks))
            self._grouped(
                self._key(arcs.head[here], arcs.step[here]), here, 1.0, least=int(limit) + 1, upper=float(limit)
            )

    def _swaps(self) -> None:
        """No two pebbles swap along a chain in one step."""
        arcs = self.arcs
        chain = self._edge_flags(lambda number: self.gadget.edges[number].kind is EdgeKind.CHAIN)
        here = np.flatnonzero(chain[arcs.edge])
        low, high = np.minimum(arcs.tail[here], arcs.head[here]), np.maximum(arcs.tail[here], arcs.head[here])
        self._grouped(self._key(low * len(self.gadget.nodes) + high, arcs.step[here]), here, 1.0, least=2, upper=1)

    def _edge_flags(self, holds: Callable[[int], bool]) -> NDArray[np.bool_]:
        """Return a flag per edge number, and a False at its end, where `WAIT` looks."""
        return np.array([*(holds(number) for number in range(len(self.gadget.edges))), False], dtype=bool)

    def _on(self, edge: int) -> Ints:
        """Return the arcs on an edge of the gadget."""
        first, last = np.searchsorted(self._edges, [edge, edge + 1])
        return self._by_edge[first:last]

    def _locations(self) -> None:
        """A location or carrier is entered or left at most once a step, and by no move while it is locked."""
        arcs, gadget = self.arcs, self.gadget
        locking = {gadget.aggregates[number].locks: index for index, number in enumerate(gadget.staging)}
        stages = {gadget.aggregates[number].gather for number in gadget.staging}
        moves: dict[str, list[int]] = {}
        for number, edge in enumerate(gadget.edges):
            for place in gadget.touched(number) if edge.head not in stages else ():
                moves.setdefault(place, []).append(number)
        for place in (*gadget.locations, *(token.name for token in gadget.tokens)):
            transfer = np.zeros(len(gadget.edges) + 1, dtype=bool)
            transfer[moves.get(place, [])] = True
            columns = np.flatnonzero(transfer[arcs.edge])
            keys = arcs.step[columns]
            touching = [number for number, aggregate in enumerate(gadget.aggregates) if place in aggregate.touches]
            if touching:
                columns = np.concatenate([columns, self.active[touching].ravel()])
                keys = np.concatenate([keys, np.tile(np.arange(arcs.horizon), len(touching))])
            if place not in locking:
                self._grouped(keys, columns, 1.0, least=2, upper=1)
                continue
            steps = np.unique(keys)
            for holds in (self.holds[locking[place]][:-1], self.holds[locking[place]][1:]):
                self._grouped(np.concatenate([keys, steps]), np.concatenate([columns, holds[steps]]), 1.0, upper=1)

    def _gathering(self, aggregate: Aggregate, holds: Ints) -> None:
        """Let h be 1 where the gathering node holds a pebble; at the start and at the end it holds none."""
        arcs = self.arcs
        here = np.flatnonzero(arcs.head == aggregate.gather)
        keys = arcs.pebble[here] * (arcs.horizon + 1) + arcs.step[here]
        groups, first = np.unique(keys, return_index=True)
        steps = arcs.step[here][first]
        self._grouped(
            np.concatenate([keys, groups]),
            np.concatenate([here, holds[steps + 1]]),
            np.concatenate([np.ones(len(here)), -np.ones(len(groups))]),
            upper=0,
        )

    def _activation(self, aggregate: Aggregate, active: Ints) -> None:
        """Pebbles take the activation edge only where it is active; the token takes it exactly there."""
        arcs, (edge,) = self.arcs, aggregate.edges
        here = self._on(edge)
        token = arcs.pebble[here] >= self.scope.blocks
        self._at_most(here[~token], active[arcs.step[here[~token]]])
        if aggregate.token is not None:
            self._balanced(here[token], active)

    def _rungs(self, aggregate: Aggregate, active: Ints) -> None:
        """The top rung is taken exactly where it is active, a further one only with the one above it."""
        self._balanced(self._on(aggregate.edges[0]), active)
        for upper, lower in pairwise(aggregate.edges):
            above, below = self._on(upper), self._on(lower)
            self._grouped(
                self.arcs.step[np.concatenate([below, above])],
                np.concatenate([below, above]),
                np.concatenate([np.ones(len(below)), -np.ones(len(above))]),
                upper=0,
            )

    def _at_most(self, columns: Ints, limits: Ints) -> None:
        """Add rows column <= limit, one for each pair."""
        entries = np.arange(len(columns))
        self._grouped(
            np.concatenate([entries, entries]),
            np.concatenate([columns, limits]),
            np.concatenate([np.ones(len(columns)), -np.ones(len(columns))]),
            upper=0,
        )

    def _balanced(self, here: Ints, active: Ints) -> None:
        """In every step the arcs `here` carry exactly one pebble where `active` is 1, and none where it is 0."""
        self._grouped(
            np.concatenate([self.arcs.step[here], np.arange(self.arcs.horizon)]),
            np.concatenate([here, active]),
            np.concatenate([np.ones(len(here)), -np.ones(self.arcs.horizon)]),
            lower=0,
            upper=0,
        )

    def _emptied(self, active: Ints, holds: Ints) -> None:
        """An activation leaves nothing in its gathering node."""
        steps = np.arange(self.arcs.horizon)
        self._grouped(np.concatenate([steps, steps]), np.concatenate([active, holds[1:]]), 1.0, upper=1)

    def _tokens(self) -> None:
        """Pebbles are in a token's node only while it is there; two tokens never stand at one station."""
        arcs, gadget = self.arcs, self.gadget
        is_token = arcs.pebble >= self.scope.blocks
        needs = np.array([node.token is not None for node in gadget.nodes], dtype=bool)
        here = np.flatnonzero(needs[arcs.head] & ~is_token)
        at, there = self._key(arcs.head, arcs.step), np.flatnonzero(is_token)
        for pebble in self.scope.moving if gadget.tokens else ():
            mine = here[arcs.pebble[here] == pebble]
            keys = np.unique(at[mine])
            tokens = there[np.isin(at[there], keys)]
            self._grouped(
                np.concatenate([at[mine], at[tokens]]),
                np.concatenate([mine, tokens]),
                np.concatenate([np.ones(len(mine)), -np.ones(len(tokens))]),
                upper=0,
            )
        if len(gadget.tokens) > 1:
            spots = {spot: number for number, spot in enumerate(dict.fromkeys(node.spot for node in gadget.nodes))}
            spot = np.array([spots[node.spot] for node in gadget.nodes], dtype=np.int64)
            self._grouped(self._key(spot[arcs.head[there]], arcs.step[there]), there, 1.0, least=2, upper=1)

    def _one_activation(self) -> None:
        """At most one activation a step: there is one manipulator."""
        if len(self.active) > 1:
            steps = np.tile(np.arange(self.arcs.horizon), len(self.active))
            self._grouped(steps, self.active.ravel(), 1.0, upper=1)

    def _arrivals(self) -> None:
        """A block that is not at its goal position enters its goal pile at least once (valid for every plan)."""
        arcs, gadget = self.arcs, self.gadget
        for pebble in self.scope.moving:
            goal = self.scope.goal[pebble]
            if goal is None:
                continue
            location = gadget.nodes[goal].location
            assert location is not None
            pile = {gadget.stack_node(location, height) for height in range(1, gadget.height + 1)}
            entering = self._edge_flags(
                lambda number, pile=pile: gadget.edges[number].head in pile and gadget.edges[number].tail not in pile  # type: ignore[misc]
            )
            here = np.flatnonzero(entering[arcs.edge] & (arcs.pebble == pebble))
            self.builder.add_row(self.columns[here], 1.0, lower=1)

    def _on_relations(self) -> None:
        """At the end a block of an `on` goal is one height above the block that it belongs on."""
        goal, arcs = self.scope.instance.goal, self.arcs
        if not isinstance(goal, OnGoal):
            return
        number = {block: pebble for pebble, block in enumerate(self.scope.instance.blocks)}
        last = arcs.step == arcs.horizon - 1
        for upper, under in goal.on.items():
            over, below = last & (arcs.pebble == number[upper]), last & (arcs.pebble == number[under])
            for node, entry in enumerate(self.gadget.nodes):
                if entry.kind is not NodeKind.STACK or entry.key.index == 1:
                    continue
                assert entry.location is not None
                base = self.gadget.stack_node(entry.location, entry.key.index - 1)
                on_top = self.columns[over & (arcs.head == node)]
                if len(on_top):
                    support = self.columns[below & (arcs.head == base)]
                    values = np.concatenate([np.ones(len(on_top)), -np.ones(len(support))])
                    self.builder.add_row(np.concatenate([on_top, support]), values, upper=0)

    def _buffers_in_order(self) -> None:
        """Symmetry: of empty buffers that are alike, one is entered only once the one before it has been used.

        b_{u,t} may be 1 from the step on in which u is entered first.
        """
        arcs, gadget, horizon = self.arcs, self.gadget, self.arcs.horizon
        for number, buffer in enumerate(self.scope.alike):
            enters = self._edge_flags(
                lambda edge, at=buffer: (
                    gadget.nodes[gadget.edges[edge].head].location == at  # type: ignore[misc]
                    and gadget.nodes[gadget.edges[edge].tail].location != at
                )
            )
            here, used = np.flatnonzero(enters[arcs.edge]), self.used[number]
            steps = np.arange(horizon)
            self._grouped(
                np.concatenate([steps, steps[1:], arcs.step[here]]),
                np.concatenate([used, used[:-1], here]),
                np.concatenate([np.ones(horizon), -np.ones(horizon - 1), -np.ones(len(here))]),
                upper=0,
            )
            if number:
                before = self.used[number - 1]
                keys = np.unique(arcs.step[here])
                self._grouped(
                    np.concatenate([arcs.step[here], keys]),
                    np.concatenate([here, before[keys]]),
                    np.concatenate([np.ones(len(here)), -np.ones(len(keys))]),
                    upper=0,
                )

    def _name(self, column: int) -> str:
        """Return a column's name: pebble, nodes and step, by number (names of blocks can be anything)."""
        arcs = self.arcs
        if column < len(arcs):
            what = "wait" if arcs.edge[column] == WAIT else self.gadget.edges[int(arcs.edge[column])].kind.value
            return f"{what}_k{arcs.pebble[column]}_v{arcs.tail[column]}_v{arcs.head[column]}_t{arcs.step[column]}"
        for name, table in (("active", self.active), ("holds", self.holds), ("used", self.used)):
            if table.size and table[0, 0] <= column <= table[-1, -1]:
                index, step = divmod(column - int(table[0, 0]), table.shape[1])
                return f"{name}_s{index}_t{step}"
        return f"x{column}"
