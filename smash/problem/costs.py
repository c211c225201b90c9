"""What actions cost: a count each (the default), more for some kinds, more for blocks that travel far.

Costs are whole numbers in a unit of the instance's choice (actions, milliseconds), so that every planner, PDDL ones
included, adds up the same figures ("costs need not be a unit action count", paper, section "Method").
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Costs:
    """The cost model of an instance.

    Attributes:
        actions: cost of each kind of action by name (`pick`, `place`, `topple`, …); 1 where it is left out.
        travel: cost of a metre that blocks are moved through the air, from where they were taken to where they are put.
        positions: where locations, the table region and stations are, in the plane [m]; needed where `travel` is not 0.
        unit: what one is, for people.
    """

    actions: Mapping[str, int] = field(default_factory=dict)
    travel: float = 0.0
    positions: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    unit: str = "actions"

    def __hash__(self) -> int:
        return hash((frozenset(self.actions.items()), self.travel, frozenset(self.positions.items()), self.unit))

    @property
    def plain(self) -> bool:
        """Whether every action costs 1, so that a plan's cost is its length."""
        return not self.travel and all(cost == 1 for cost in self.actions.values())

    def of(self, action: str) -> int:
        """Return the cost of an action of this name, travel apart."""
        return self.actions.get(action, 1)

    def distance(self, origin: str, target: str) -> int:
        """Return the cost of the way between two places."""
        if not self.travel or origin == target:
            return 0
        return round(self.travel * math.dist(self.positions[origin], self.positions[target]))


UNIT_COSTS = Costs()
