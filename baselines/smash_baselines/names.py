"""PDDL names for an instance's blocks and locations: fixed width, mapped back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from smash.problem.model import Instance

Fact = tuple[str, ...]
"""A predicate and its arguments, by PDDL names: `("on", "b02", "b01")`."""
Step = tuple[str, ...]
"""A grounded PDDL action: its name and its arguments, `("pick", "b02", "b01")`."""


@dataclass(frozen=True, slots=True)
class Names:
    """Our names to PDDL names and back. A block `b01`, a stack location `s01`, a count `n01`.

    Instances may call a block and a location alike, and by any string; PDDL knows neither. Fixed widths keep
    the planners' alphabetical order that of the instance.
    """

    blocks: Mapping[str, str]
    locations: Mapping[str, str]
    block_of: Mapping[str, str] = field(init=False)
    location_of: Mapping[str, str] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "block_of", {short: name for name, short in self.blocks.items()})
        object.__setattr__(self, "location_of", {short: name for name, short in self.locations.items()})

    @classmethod
    def of(cls, instance: Instance) -> Names:
        """Number the blocks and the stack locations of `instance` in its order."""
        return cls(numbered("b", instance.blocks), numbered("s", instance.stacks))


def numbered(letter: str, names: Iterable[str]) -> dict[str, str]:
    """Map each name to the letter and its 1-based number, at least two digits wide."""
    listed = list(names)
    width = max(2, len(str(len(listed))))
    return {name: f"{letter}{number:0{width}}" for number, name in enumerate(listed, start=1)}


def count_names(most: int) -> list[str]:
    """Return the objects that count from 0 to `most`."""
    width = max(2, len(str(most)))
    return [f"n{number:0{width}}" for number in range(most + 1)]
