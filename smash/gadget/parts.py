"""What an aggregating action is to the gadget: a part that adds nodes and edges and reads actions off them."""

from __future__ import annotations

from collections.abc import Collection
from typing import Protocol

from smash.gadget.graph import GadgetBuilder
from smash.problem.model import Action, State


class AggregatingPart(Protocol):
    """One aggregating action (topple, …) as a part of a gadget. Each lives in one small file.

    The part says where the action gathers objects, how many, what it costs and whether its outcome is grounded
    (all in `Aggregate`), and which action of the law an activation stands for. Models, the motion rules and the
    decoding ask nothing else.
    """

    @property
    def name(self) -> str:
        """The action's name, unique in a gadget."""
        ...

    def extend(self, builder: GadgetBuilder) -> None:
        """Add the part's nodes, edges and aggregates."""
        ...

    def action(self, location: str, blocks: Collection[str], state: State) -> Action:
        """Return the action that moves `blocks` at once from `location`, in the state before it."""
        ...

    def gathered(self, action: Action, state: State) -> tuple[str, tuple[str, ...]] | None:
        """Return the location and the blocks that `action` moves at once, topmost first; None: not this part's."""
        ...
