"""Making and growing the node store, as lists (interpreted) or numpy arrays (compiled)."""

from __future__ import annotations

import os
from typing import Any

from smash.planners.astar import search
from smash.planners.astar.compiled import Code
from smash.planners.astar.pattern_sets import Patterns
from smash.planners.astar.search import Store
from smash.planners.astar.task import Ints, Task

KINDS = {
    "states": "u1",
    "cost": "i4",
    "estimate": "i4",
    "parent": "i4",
    "moved": "i4",
    "code": "i4",
    "following": "i4",
    "stale": "u1",
    "table": "i4",
    "heads": "i4",
    "counters": "i8",
}
"""The numpy type of each array."""
PER_NODE = ("cost", "estimate", "parent", "moved", "code", "following", "stale")
NODE_BYTES = 25 + 8
"""Memory of a node beside its state: its entries, and its share of a hash table half full [bytes]."""
MOST_MEMORY = 2 << 30
"""The most memory that a search takes [bytes], if half of what is free is not less."""


def zeros(size: int, kind: str, compiled: bool, value: int = 0) -> Ints:
    """Return an array of `size` times `value`."""
    if not compiled:
        return [value] * size
    import numpy as np

    # Of what is never touched nothing is written: of a large state many nodes' room stays empty.
    array: Any = np.full(size, value, dtype=kind) if value else np.zeros(size, dtype=kind)
    return array  # type: ignore[no-any-return]


def filled(values: list[int], compiled: bool, kind: str = "i8") -> Ints:
    """Return `values` as an array."""
    array = zeros(len(values), kind, compiled)
    array[:] = values
    return array


def make_store(
    task: Task, compiled: bool, nodes: int, first: int, upper: int, patterns: Patterns | None = None
) -> Store:
    """Return an empty store for `nodes` nodes with estimates from `first` up to `upper`.

    Args:
        task: the problem's numbers.
        compiled: whether compiled functions will use it.
        nodes: the most that fit.
        first: the least estimate.
        upper: the cost that plans have to be below.
        patterns: databases that bound the cost beside `lower_bound`.
    """
    patterns = patterns or Patterns.none(compiled)
    table = table_size(nodes)
    width = upper + 1
    sizes = {
        "states": nodes * task.width * task.blocks,
        "table": table,
        "heads": (upper - first + 1) * width,
        "counters": 5,
    }
    arrays = {
        name: zeros(sizes.get(name, nodes), kind, compiled, -1 if name == "heads" else 0)
        for name, kind in KINDS.items()
    }
    shape = filled([first, width, nodes, table], compiled)
    store = Store(**arrays, shape=shape, layout=patterns.layout, tables=patterns.tables)
    store.counters[search.UPPER] = upper
    store.counters[search.BEST] = -1
    store.counters[search.FLOOR] = first
    return store


def grown(task: Task, store: Store, nodes: int, code: Code, compiled: bool) -> Store:
    """Return a store with room for `nodes` nodes and all that `store` holds."""
    arrays: dict[str, Any] = store._asdict()
    for name in ("states", *PER_NODE):
        larger = zeros(nodes * (task.width * task.blocks if name == "states" else 1), KINDS[name], compiled)
        larger[: len(arrays[name])] = arrays[name]
        arrays[name] = larger
    arrays["table"] = zeros(table_size(nodes), KINDS["table"], compiled)
    arrays["shape"] = filled([*(int(entry) for entry in store.shape[:2]), nodes, len(arrays["table"])], compiled)
    larger_store = Store(**arrays)
    code.file_again(task, larger_store)
    return larger_store


def table_size(nodes: int) -> int:
    """Return the size of the hash table: a power of two, at most half full."""
    return 1 << max(4, (2 * nodes - 1).bit_length())


def most_nodes(size: int, memory: int) -> int:
    """Return how many nodes of states of `size` bytes fit, when the last growth copies the largest array."""
    return max(1, memory // (2 * size + NODE_BYTES + 8))


def free_memory() -> int:
    """Return how much memory a search may take: half of what is free, at most `MOST_MEMORY` [bytes]."""
    try:
        free = os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (ValueError, OSError):
        return MOST_MEMORY
    return min(MOST_MEMORY, free // 2)
