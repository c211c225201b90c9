"""An instance set: `python examples/extend/instance_set.py DIR` writes towers that are to move as they stand.

Picking and placing turns a tower over; a topple lets its blocks be rebuilt in any order.
"""

import sys
from pathlib import Path

import smash


def tower(blocks: int, buffers: int = 2) -> smash.Instance:
    """Return the instance: all blocks of `s1`, in the same order, to `s2`."""
    names = [f"b{number}" for number in range(1, blocks + 1)]
    return smash.make_instance({"s1": names}, {"s2": names}, name=f"tower-{blocks}", stacks=1, buffers=buffers)


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for size in (2, 4, 6):
        smash.write_instance(tower(size), folder / f"tower-{size}.json")
