"""The gadgets of the paper, by name: pick and place, SMASH, and the one that fits an instance.

What is printed and what is built differ where DESIGN's law needs it; `literal=True` builds the printed form:

| printed definition                           | built here                                                   |
|----------------------------------------------|--------------------------------------------------------------|
| chain edges (v_s^i, v_s^{i+1}) upward only    | both ways, or no block could come to rest below the top      |
| cost 1 of a cross-stack or table-to-stack edge | 2: a pick and a place                                        |
| a TOPPLE node for each of the S locations     | for `stacks` only: buffers have no topple region beside them |
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

from smash.gadget.builder import GadgetBuilder
from smash.gadget.elements import EdgeKind, NodeKind
from smash.gadget.graph import Gadget
from smash.gadget.parts.registry import parts_of
from smash.gadget.parts.topple import TopplePart
from smash.problem.costs import UNIT_COSTS, Costs
from smash.problem.model import Instance, PlanOptions


def pick_and_place_gadget(locations: Iterable[str], height: int, *, literal: bool = False) -> Gadget:
    """Return G_PAP (paper, definition "Pick and place gadget").

    V_PAP: (v_s^i, 1) for each height i and location s. E_PAP: the chains of each location at cost 0, and
    (v_u^l, v_w^l) between the tops of any two locations.

    Args:
        locations: the S stack locations, buffers included.
        height: l, the number of objects.
        literal: the printed form (see the module's table).
    """
    return _pick_and_place(locations, height, literal).build()


def smash_gadget(
    locations: Iterable[str],
    height: int,
    *,
    stacks: Iterable[str] | None = None,
    max_topple: int | None = None,
    literal: bool = False,
) -> Gadget:
    """Return G_SMASH = G_PAP ∪ G^+_SMASH (paper, definition "SMASH Gadget").

    Args:
        locations: the S stack locations, buffers included.
        height: l, the number of objects.
        stacks: the locations that can be toppled; None: all.
        max_topple: capacity of a topple where it is smaller than l.
        literal: the printed form: every location has a TOPPLE node, and the module's table.
    """
    builder = _pick_and_place(locations, height, literal)
    toppled = builder.locations if stacks is None or literal else tuple(stacks)
    most = height if max_topple is None else min(height, max_topple)
    builder.add_part(TopplePart(toppled, most))
    return builder.build()


def gadget_of(instance: Instance, options: PlanOptions | None = None) -> Gadget:
    """Return the gadget of an instance: `stacks` and `buffers` as locations, a part per aggregating action that it has.

    What holds blocks at the start (the table region, a carrier) is part of the gadget also where its action is not
    allowed.
    """
    options = options or PlanOptions()
    builder = _pick_and_place(instance.locations, len(instance.blocks), literal=False, costs=instance.costs)
    for part in parts_of(instance, options):
        builder.add_part(part)
    return builder.build()


def _pick_and_place(locations: Iterable[str], height: int, literal: bool, costs: Costs = UNIT_COSTS) -> GadgetBuilder:
    builder = GadgetBuilder(locations, height, costs, literal=literal)
    for location in builder.locations:
        chain = [builder.add_node(NodeKind.STACK, 1, location, index, spot=location) for index in range(1, height + 1)]
        for lower, upper in pairwise(chain):
            builder.add_edge(lower, upper, EdgeKind.CHAIN, 0, 1)
            if not literal:
                builder.add_edge(upper, lower, EdgeKind.CHAIN, 0, 1)
    if height:
        builder.join([builder.top(location) for location in builder.locations])
    return builder
