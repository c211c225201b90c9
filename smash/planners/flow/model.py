"""The paper's time-expanded multi-commodity flow on a gadget, as a MILP ("Computing a candidate task plan").

Column x_j is 1 where pebble k takes arc j of the time-expanded graph. Beside the x there is, per aggregate and
step, a_{s,t} = 1 where TOPPLE node v_{T_s} is active (its cost is paid here, once), and, per aggregate and layer,
h_{s,t} = 1 where v_{T_s} holds a pebble. The rows are those of DESIGN's "what one step may hold"; the same rules
are in words in `smash.gadget.motion.motion_fault`. Nothing here knows which aggregating actions the gadget has.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smash.gadget import EdgeKind, NodeKind
from smash.gadget.motion import PebbleMotion
from smash.planners.flow.arcs import WAIT, Arcs, arcs_of
from smash.planners.flow.reach import Reach
from smash.planners.flow.scope import Scope
from smash.planners.milp import Floats, Ints, Milp, MilpBuilder
from smash.problem.model import OnGoal


@dataclass(frozen=True)
class FlowModel:
    """A built model and what is needed to read its solutions.

    Attributes:
        scope: pebbles and gadget.
        arcs: the first columns of the model, in order.
        milp: the model.
        active: first column of a_{s,t}, by (aggregate, step); shape (aggregates, T).
        holds: column of h_{s,t}, by (aggregate, layer); shape (aggregates, T + 1).
    """

    scope: Scope
    arcs: Arcs
    milp: Milp
    active: Ints
    holds: Ints

    def motion(self, vector: Floats) -> PebbleMotion:
        """Read the pebble motion off a solution."""
        scope, arcs = self.scope, self.arcs
        layers = np.tile(np.array(scope.start, dtype=np.int64), (arcs.horizon + 1, 1))
        used = np.flatnonzero(vector[: len(arcs)] > 0.5)
        layers[arcs.step[used] + 1, arcs.pebble[used]] = arcs.head[used]
        return PebbleMotion(scope.gadget, scope.instance.blocks, tuple(map(tuple, layers.tolist())))

    def vector(self, motion: PebbleMotion) -> Floats | None:
        """Return the solution that stands for a motion, or None where it takes an arc that the model lacks."""
        arcs, gadget = self.arcs, self.scope.gadget
        if motion.steps > arcs.horizon:
            return None
        layers = np.array(motion.padded(arcs.horizon).layers, dtype=np.int64)
        matches = (layers[arcs.step, arcs.pebble] == arcs.tail) & (layers[arcs.step + 1, arcs.pebble] == arcs.head)
        vector = np.zeros(self.milp.columns)
        vector[: len(arcs)] = matches
        for index, aggregate in enumerate(gadget.aggregates):
            held = (layers == aggregate.gather).any(axis=1)
            vector[self.holds[index]] = held
            vector[self.active[index]] = (
                (layers[:-1] == aggregate.gather) & (layers[1:] == gadget.edges[aggregate.edge].head)
            ).any(axis=1)
        return vector if self.milp.violation(vector) < 1e-6 else None


def build(scope: Scope, reaches: dict[int, Reach], horizon: int) -> FlowModel:
    """Build the model of a scope for a horizon of T steps."""
    return _Assembly(scope, arcs_of(scope, reaches, horizon)).model()


class _Assembly:
    """Adds the columns and the rows, one kind of row a method."""

    def __init__(self, scope: Scope, arcs: Arcs) -> None:
        self.scope, self.arcs, self.gadget = scope, arcs, scope.gadget
        self.builder = MilpBuilder()
        aggregates, horizon = len(self.gadget.aggregates), arcs.horizon
        is_activation = np.zeros(len(self.gadget.edges) + 1, dtype=bool)
        is_activation[list(self.gadget.activations)] = True
        costs = np.array([*(edge.cost for edge in self.gadget.edges), 0], dtype=float)
        self.columns = self.builder.add_columns(len(arcs), cost=np.where(is_activation, 0, costs)[arcs.edge])
        prices = [self.gadget.edges[aggregate.edge].cost for aggregate in self.gadget.aggregates]
        active = self.builder.add_columns(aggregates * horizon, cost=np.repeat(np.array(prices, dtype=float), horizon))
        holds = self.builder.add_columns(aggregates * (horizon + 1))
        self.active, self.holds = active.reshape(aggregates, horizon), holds.reshape(aggregates, horizon + 1)

    def model(self) -> FlowModel:
        self._conservation()
        self._node_capacities()
        self._swaps()
        self._locations()
        for index in range(len(self.gadget.aggregates)):
            self._gathering(index)
            self._activation(index)
        self._one_activation()
        self._arrivals()
        self._on_relations()
        return FlowModel(self.scope, self.arcs, self.builder.build(self._name), self.active, self.holds)

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
        for pebble in self.scope.moving:
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
        """No node holds more pebbles than its capacity."""
        arcs = self.arcs
        capacity = np.array([node.capacity for node in self.gadget.nodes], dtype=np.int64)
        for limit in np.unique(capacity[capacity < len(self.scope.moving)]):
            here = np.flatnonzero(capacity[arcs.head] == limit)
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

    def _locations(self) -> None:
        """A location is entered or left by its top at most once a step, and by no transfer while it is locked."""
        arcs, gadget = self.arcs, self.gadget
        locking = {aggregate.locks: index for index, aggregate in enumerate(gadget.aggregates) if aggregate.locks}
        for location in gadget.locations:
            transfer = self._edge_flags(
                lambda number, at=location: at in gadget.touched(number) and not self._gathers(number)  # type: ignore[misc]
            )
            here = np.flatnonzero(transfer[arcs.edge])
            if location not in locking:
                self._grouped(arcs.step[here], here, 1.0, least=2, upper=1)
                continue
            steps = np.unique(arcs.step[here])
            for holds in (self.holds[locking[location]][:-1], self.holds[locking[location]][1:]):
                keys, columns = np.concatenate([arcs.step[here], steps]), np.concatenate([here, holds[steps]])
                self._grouped(keys, columns, 1.0, upper=1)

    def _gathers(self, number: int) -> bool:
        head = self.gadget.edges[number].head
        return any(aggregate.gather == head for aggregate in self.gadget.aggregates)

    def _gathering(self, index: int) -> None:
        """Let h be 1 where the gathering node holds a pebble; at the start and at the end it holds none."""
        arcs, aggregate = self.arcs, self.gadget.aggregates[index]
        here = np.flatnonzero(arcs.head == aggregate.gather)
        keys = arcs.pebble[here] * (arcs.horizon + 1) + arcs.step[here]
        groups, first = np.unique(keys, return_index=True)
        steps = arcs.step[here][first]
        self._grouped(
            np.concatenate([keys, groups]),
            np.concatenate([here, self.holds[index][steps + 1]]),
            np.concatenate([np.ones(len(here)), -np.ones(len(groups))]),
            upper=0,
        )

    def _activation(self, index: int) -> None:
        """Pebbles take the activation edge only where it is active; it then empties the gathering node."""
        arcs, aggregate = self.arcs, self.gadget.aggregates[index]
        here = np.flatnonzero(arcs.edge == aggregate.edge)
        entries = np.arange(len(here))
        self._grouped(
            np.concatenate([entries, entries]),
            np.concatenate([here, self.active[index][arcs.step[here]]]),
            np.concatenate([np.ones(len(here)), -np.ones(len(here))]),
            upper=0,
        )
        steps = np.arange(arcs.horizon)
        columns = np.concatenate([self.active[index], self.holds[index][1:]])
        self._grouped(np.concatenate([steps, steps]), columns, 1.0, upper=1)

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
            top = gadget.top(location)
            entering = self._edge_flags(
                lambda number, top=top: (
                    gadget.edges[number].head == top  # type: ignore[misc]
                    and gadget.edges[number].kind is not EdgeKind.CHAIN
                )
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

    def _name(self, column: int) -> str:
        """Return a column's name: pebble, nodes and step, by number (names of blocks can be anything)."""
        arcs = self.arcs
        if column < len(arcs):
            what = "wait" if arcs.edge[column] == WAIT else self.gadget.edges[int(arcs.edge[column])].kind.value
            return f"{what}_k{arcs.pebble[column]}_v{arcs.tail[column]}_v{arcs.head[column]}_t{arcs.step[column]}"
        for name, table in (("active", self.active), ("holds", self.holds)):
            if table.size and table[0, 0] <= column <= table[-1, -1]:
                index, step = divmod(column - int(table[0, 0]), table.shape[1])
                return f"{name}_s{index}_t{step}"
        return f"x{column}"
