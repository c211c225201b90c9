"""What an aggregating action is to the gadget: a part that adds nodes and edges and reads actions off them."""

from __future__ import annotations

from collections.abc import Collection
from typing import Protocol

from smash.gadget.graph import Aggregate, GadgetBuilder
from smash.problem.model import Aggregating, State


class AggregatingPart(Protocol):
    """One aggregating action (topple, …) as a part of a gadget. Each lives in one small file.

    The part says where the action gathers objects, how many, what it costs, what it locks and touches, and whether
    its outcome is grounded (all in `Aggregate`), and which action of the law an activation stands for. Models, the
    motion rules, encoding, decoding and drawing ask nothing else.
    """

    @property
    def name(self) -> str:
        """The action's name, unique in a gadget, as in `smash.problem.family`."""
        ...

    @property
    def stacks_several(self) -> bool:
        """Whether an activation puts blocks on a pile (one that takes what is in place, and keeps its order)."""
        ...

    def extend(self, builder: GadgetBuilder) -> None:
        """Add the part's nodes, edges, tokens and aggregates."""
        ...

    def action(self, aggregate: Aggregate, blocks: Collection[str], state: State) -> Aggregating:
        """Return the action that an activation of `aggregate` with `blocks` stands for, in the state before it."""
        ...

    def at(self, action: Aggregating, state: State) -> tuple[str, ...] | None:
        """Return the `at` of the aggregate that `action` activates in the state before it; None: not this part's."""
        ...
