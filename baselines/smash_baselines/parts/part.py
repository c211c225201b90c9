"""What one action of the family is to PDDL: a file of `domains/parts`, and how it is said in facts and steps."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

from smash.problem.actions.kind import allowed
from smash.problem.actions.registry import FAMILY
from smash.problem.model import Action, Instance, PlanOptions, State
from smash_baselines.domains import DOMAINS
from smash_baselines.names import Fact, Step
from smash_baselines.parts.layout import Layout

PARTS = DOMAINS / "parts"


@dataclass(frozen=True, slots=True)
class Telling:
    """What a part tells of: an instance under plan options, and the PDDL names of what is in it.

    `wanted` are the blocks that may be picked from the table region.
    """

    instance: Instance
    options: PlanOptions
    layout: Layout
    wanted: Collection[str]

    def block(self, name: str) -> str:
        """Return the PDDL name of a block."""
        return self.layout.names.blocks[name]

    def named(self, short: str) -> str:
        """Return the block that a PDDL name stands for."""
        return self.layout.names.block_of[short]

    def where(self, state: State, short: str) -> tuple[str, int]:
        """Return the location and the 1-based height of a block, by its PDDL name.

        Raises:
            ValueError: where it is in no pile.
        """
        name = self.named(short)
        for location, pile in state.piles.items():
            if name in pile:
                return location, pile.index(name) + 1
        raise ValueError(f"{short} is in no pile")

    def base(self, location: str) -> str | None:
        """Return the PDDL name of a stack location, or None for a buffer: those are counted."""
        return self.layout.names.locations.get(location)


class Part(ABC):
    """One part of the domains: the PDDL text, the facts of the start, and steps to actions and back.

    Attributes:
        kind: the aggregating action's name in the law's family.
        blocks_only_hinder: whether a legal action stays legal or becomes needless, at no higher cost, where a block
            less is in the piles and on the carriers; then engines leave on the table what the goal does not name.
    """

    kind: ClassVar[str]
    blocks_only_hinder: ClassVar[bool] = False

    def needed(self, instance: Instance, options: PlanOptions) -> bool:
        """Return whether the domain of this instance has the part."""
        return allowed(FAMILY[self.kind], instance, options)

    def file(self, instance: Instance, options: PlanOptions) -> str:
        """Return the name of its text: of the file in `domains/parts`, without its ending."""
        return self.kind

    def text(self, instance: Instance, options: PlanOptions) -> str:
        """Return its PDDL text: types, predicates and functions, then actions after a line `; --- …`."""
        return (PARTS / f"{self.file(instance, options)}.pddl").read_text(encoding="utf-8")

    def objects(self, telling: Telling) -> Mapping[str, tuple[str, ...]]:
        """Return the objects that it adds, by type."""
        return {}

    @abstractmethod
    def start(self, telling: Telling) -> Iterator[Fact]:
        """Yield the facts that it adds to the start."""

    @abstractmethod
    def costs(self, telling: Telling) -> Iterator[tuple[Fact, int]]:
        """Yield the values of its cost functions."""

    @abstractmethod
    def tells(self, telling: Telling, action: Action) -> bool:
        """Return whether this part says `action`."""

    @abstractmethod
    def steps(self, telling: Telling, state: State, action: Action) -> Iterator[Step]:
        """Yield the steps of an action that it says, legal in `state`."""

    @abstractmethod
    def action(self, telling: Telling, state: State, step: Step) -> Action | None:
        """Return the action that one of its steps completes; None: more steps are to come, or nothing has changed.

        Args:
            telling: the problem.
            state: the state before the action, also where earlier steps have begun it.
            step: a grounded action of its file.
        """


def step_names(text: str) -> list[str]:
    """Return the names of the PDDL actions in a part's text."""
    return re.findall(r"^\(:action\s+(\S+)", text, re.MULTILINE)
