"""An instance set: `python examples/instance_set.py DIR` writes towers that are to move as they stand.

Picking and placing turns a tower over; a topple lets its blocks be rebuilt in any order.
"""

import sys
from pathlib import Path

from smash.problem import Instance, StacksGoal, make_instance, write_instance


def tower(blocks: int, buffers: int = 2) -> Instance:
    """Return the instance: all blocks of `s1`, in the same order, to `s2`."""
    names = tuple(f"b{number}" for number in range(1, blocks + 1))
    return make_instance(
        name=f"tower-{blocks}",
        blocks=names,
        stacks=["s1", "s2", "s3"],
        buffers=[f"u{number}" for number in range(1, buffers + 1)],
        start={"s1": names},
        goal=StacksGoal({"s2": names}),
    )


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for size in (2, 4, 6):
        write_instance(tower(size), folder / f"tower-{size}.json")
