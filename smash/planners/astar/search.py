"""A* over filed states: a hash table, buckets by cost estimate, nodes that only grow (compiled)."""

from __future__ import annotations

from typing import NamedTuple

from smash.planners.astar.bound import lower_bound
from smash.planners.astar.moves import list_moves
from smash.planners.astar.patterns import pattern_bound
from smash.planners.astar.state import apply_move, is_goal, pack, settle, unpack
from smash.planners.astar.task import Ints, Task

NODES, UPPER, BEST, FLOOR, EXPANDED = range(5)
"""Entries of `Store.counters`: nodes filed; cost of the best plan known and the node that reached it (-1: it came
from outside); the least estimate among the open nodes; nodes expanded."""
RUNNING, PROVEN, FULL, DONE = range(4)
"""What `expand_some` ends with: its share is done; no cheaper plan exists; the store is full. `_expand` also with the
last: every move was tried."""
DROPPED, NO_ROOM = -1, -2
"""What `file_node` returns where it files nothing that is to be expanded."""
MASK = (1 << 40) - 1


class Store(NamedTuple):
    """The nodes of a search. `states` holds `width * blocks` bytes a node; `table` node + 1 by hash, 0 where free."""

    states: Ints
    cost: Ints
    estimate: Ints
    parent: Ints
    moved: Ints
    code: Ints
    following: Ints
    """Per node the next of its bucket, -1 at the end."""
    stale: Ints
    """1 where a cheaper way to the same state was filed as a node of its own."""
    table: Ints
    heads: Ints
    """Per bucket `(estimate - first) * width + (estimate - cost)` its first node, -1 where empty."""
    counters: Ints
    shape: Ints
    """[0]: the least cost possible (a plan that cheap is found deepest first); [1]: width of the buckets;
    [2]: the most nodes; [3]: size of `table`."""
    layout: Ints
    tables: Ints
    """Of the pattern databases (`patterns.pattern_bound`)."""


def file_state(task: Task, cells: Ints, store: Store, parent: int, cost: int, moved: int, code: int) -> bool:
    """File the state in hand in its bucket, settled first, unless it is known as cheap or leads to no better plan.

    Returns:
        Whether there was room.
    """
    least = store.shape[0]
    if parent >= 0 and store.estimate[parent] > least:
        least = store.estimate[parent]
    node = file_node(task, cells, store, parent, cost, moved, code, least)
    if node < 0:
        return node != NO_ROOM
    estimate = store.estimate[node]
    bucket = (estimate - store.shape[0]) * store.shape[1] + estimate - store.cost[node]
    store.following[node] = store.heads[bucket]
    store.heads[bucket] = node
    return True


def file_node(task: Task, cells: Ints, store: Store, parent: int, cost: int, moved: int, code: int, least: int) -> int:
    """File the state in hand, settled first, as a node; `least` is a bound on the plans through its parent.

    Returns:
        The node; DROPPED where the state is known as cheap, leads to no better plan or is a goal; or NO_ROOM.
    """
    cost += 2 * settle(task, cells)
    counters = store.counters
    estimate = max(cost + lower_bound(task, cells), least)
    if estimate < counters[UPPER] and store.layout[0] > 0:
        estimate = max(estimate, cost + pattern_bound(task, cells, store.layout, store.tables))
    if estimate >= counters[UPPER]:
        return DROPPED
    size = task.width * task.blocks
    node = counters[NODES]
    if node == store.shape[2]:
        return NO_ROOM
    pack(task, cells, store.states, node * size)
    place = _place_of(store, size, node)
    known = store.table[place] - 1
    if known >= 0:
        if store.cost[known] <= cost:
            return DROPPED
        store.stale[known] = 1
    store.table[place] = node + 1
    store.cost[node] = cost
    store.estimate[node] = estimate
    store.parent[node] = parent
    store.moved[node] = moved
    store.code[node] = code
    store.stale[node] = 0
    counters[NODES] = node + 1
    if is_goal(task, cells):
        counters[UPPER] = cost
        counters[BEST] = node
        return DROPPED
    return int(node)


def _place_of(store: Store, size: int, node: int) -> int:
    """Return where the state of `node`, of `size` bytes, stands in the table, or the free entry where it belongs."""
    states, table = store.states, store.table
    first = node * size
    number = 0
    for index in range(first, first + size):
        number = ((number ^ states[index]) * 1048583) & MASK
        number ^= number >> 17
    place = number & (store.shape[3] - 1)
    while table[place] != 0:
        other = (table[place] - 1) * size
        index = 0
        while index < size and states[other + index] == states[first + index]:
            index += 1
        if index == size:
            return place
        place = (place + 1) & (store.shape[3] - 1)
    return place


def file_again(task: Task, store: Store) -> None:
    """Fill an emptied, larger `table` from the nodes."""
    for node in range(store.counters[NODES]):
        if store.stale[node] == 0:
            store.table[_place_of(store, task.width * task.blocks, node)] = node + 1


def expand_some(task: Task, cells: Ints, store: Store, share: int) -> int:
    """Expand up to `share` nodes, trying no more than `allowed` moves, cheapest estimate first, deepest among equals.

    Returns:
        RUNNING, PROVEN (no plan is cheaper than `UPPER`) or FULL.
    """
    counters = store.counters
    width = store.shape[1]
    done = 0
    while counters[FLOOR] < counters[UPPER]:
        bucket = (counters[FLOOR] - store.shape[0]) * width
        remaining = 0
        while remaining < width:
            node = store.heads[bucket + remaining]
            if node < 0:
                remaining += 1
                continue
            if done == share:
                return RUNNING
            if store.stale[node] == 0:
                outcome = _expand(task, cells, store, node)
                if outcome != DONE:
                    return outcome
                done += 1
                counters[EXPANDED] += 1
            store.heads[bucket + remaining] = store.following[node]
            remaining = 0
            if counters[FLOOR] >= counters[UPPER]:
                return PROVEN
        counters[FLOOR] += 1
    return PROVEN


def _expand(task: Task, cells: Ints, store: Store, node: int) -> int:
    """File every state one move away.

    Returns:
        DONE, FULL (the node is expanded again then), or RUNNING where no more moves are allowed (it is gone on with).
    """
    offset = node * task.width * task.blocks
    unpack(task, cells, store.states, offset)
    settle(task, cells)
    for number in range(first_move(task, cells, node), list_moves(task, cells)):
        if not may_try(task, cells, node, number):
            return RUNNING
        block = cells[task.moves + 2 * number]
        code = cells[task.moves + 2 * number + 1]
        unpack(task, cells, store.states, offset)
        cost = store.cost[node] + apply_move(task, cells, block, code)
        if not file_state(task, cells, store, node, cost, block, code):
            return FULL
    return DONE


def first_move(task: Task, cells: Ints, node: int) -> int:
    """Return the first move of a state that is to be tried: not 0 where its expansion was broken off."""
    number = cells[task.resume] if cells[task.resumed] == node else 0
    cells[task.resumed] = -1
    return number


def may_try(task: Task, cells: Ints, node: int, number: int) -> bool:
    """Return whether move `number` of a state may still be tried; note where to go on with it where not."""
    if cells[task.allowed] <= 0:
        cells[task.resumed] = node
        cells[task.resume] = number
        return False
    cells[task.allowed] -= 1
    return True
