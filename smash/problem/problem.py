"""The traveller: an instance, what a plan of it may use, and all that follows from the two, each worked out once.

Whoever plans, checks or models takes a `Problem` and passes it on; nobody works out anew what it knows.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from smash.problem.buffers import with_buffers
from smash.problem.feasibility import why_infeasible
from smash.problem.model import Instance, PlanOptions, State
from smash.problem.rules import Law
from smash.problem.views.demands import Demands, demands_of
from smash.problem.views.numbered import Numbered
from smash.problem.views.posed import open_rest, posed
from smash.problem.views.twin import plain_twin

if TYPE_CHECKING:
    from smash.problem.actions.kind import AggregatingKind


@dataclass(frozen=True)
class Problem:
    """An instance and what its plans may use; equal where both are.

    Attributes:
        instance: what is to be rearranged.
        options: what a plan may use.
    """

    instance: Instance
    options: PlanOptions = field(default_factory=PlanOptions)

    def __getstate__(self) -> dict[str, Any]:
        """Return what a copy is made of: what follows is worked out anew where it is needed."""
        return {"instance": self.instance, "options": self.options}

    @cached_property
    def law(self) -> Law:
        """The law of this instance under these options."""
        return Law(self.instance, self.options)

    @property
    def kinds(self) -> tuple[AggregatingKind[Any], ...]:
        """The kinds of aggregating actions that plans may use, in the order of the registry."""
        return self.law.kinds

    @cached_property
    def plain(self) -> bool:
        """Whether there is pick, place and topple alone, each at cost 1: what the fast methods count."""
        further = any(kind.name != "topple" for kind in self.kinds)
        return not further and self.instance.costs.plain and not any(c.holds for c in self.instance.carriers)

    @cached_property
    def infeasible(self) -> str | None:
        """In one line why there is no plan, where start and goal alone show it; None elsewhere."""
        return why_infeasible(self.law)

    @cached_property
    def solved(self) -> bool:
        """Whether the start fulfils the goal."""
        return self.law.goal_shortfall(State.start_of(self.instance)) is None

    @cached_property
    def posed(self) -> Instance:
        """The instance with an equivalent goal that uses `bottom` in place of `ontable` and `clear` where it can."""
        return posed(self.instance, falls=bool(self.kinds))

    @cached_property
    def as_posed(self) -> Problem:
        """The problem of the posed instance; this problem where that is the same."""
        return self if self.posed is self.instance else self._like(self.posed, self.kinds)

    @cached_property
    def open_rest(self) -> str | None:
        """In a few words what the goal leaves open by `ontable` and `clear`; None where it comes to `bottom` alone."""
        return open_rest(self.posed)

    @cached_property
    def numbered(self) -> Numbered:
        """The posed instance with numbers in place of names; the hand must be empty at the start."""
        return Numbered.of(self.posed)

    @cached_property
    def demands(self) -> Demands:
        """What the goal asks of the blocks: who must leave, who must be placed, in which order."""
        return demands_of(self.posed)

    @cached_property
    def twin(self) -> Problem:
        """The plain twin, whose plans are plans of this problem (`from_twin`); this problem where it is plain."""
        if self.plain:
            return self
        return self._like(plain_twin(self.instance), tuple(kind for kind in self.kinds if kind.name == "topple"))

    def _like(self, instance: Instance, kinds: tuple[AggregatingKind[Any], ...]) -> Problem:
        """Return the problem of another instance, whose kinds are known: nobody has to be asked again."""
        other = Problem(instance, self.options)
        vars(other)["law"] = Law(instance, self.options, kinds)
        return other

    def with_buffers(self, count: int) -> Problem:
        """Return the problem with `count` buffers.

        Raises:
            MalformedFile: where more buffers hold blocks at the start.
        """
        return Problem(with_buffers(self.instance, count), self.options)
