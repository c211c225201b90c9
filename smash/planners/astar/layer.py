"""One layer of a beam search: its states are expanded into the nodes of a store (compiled, see `compiled`)."""

from __future__ import annotations

from smash.planners.astar.moves import list_moves
from smash.planners.astar.search import NO_ROOM, Store, file_node, first_move, may_try
from smash.planners.astar.state import apply_move, settle, unpack
from smash.planners.astar.task import Ints, Task


def expand_layer(
    task: Task, cells: Ints, rows: Ints, costs: Ints, estimates: Ints, store: Store, begin: int, end: int
) -> int:
    """File what lies one move away from the states `begin .. end-1` of a layer; their numbers are the parents.

    Args:
        task: the problem's numbers.
        cells: the state in hand.
        rows: the layer's states, `width * blocks` bytes each.
        costs: what it costs to reach each.
        estimates: a bound on the plans through each.
        store: takes the new nodes.
        begin: the first state to expand.
        end: the one after the last.

    Returns:
        `end`, or the state at which the store was full: with more room it is to be expanded again; or the one at which
        no more moves were allowed.
    """
    for parent in range(begin, end):
        offset = parent * task.width * task.blocks
        unpack(task, cells, rows, offset)
        settle(task, cells)
        for number in range(first_move(task, cells, parent), list_moves(task, cells)):
            if not may_try(task, cells, parent, number):
                return parent
            block = cells[task.moves + 2 * number]
            code = cells[task.moves + 2 * number + 1]
            unpack(task, cells, rows, offset)
            cost = costs[parent] + apply_move(task, cells, block, code)
            if file_node(task, cells, store, parent, cost, block, code, estimates[parent]) == NO_ROOM:
                return parent
    return end
