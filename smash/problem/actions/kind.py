"""What an aggregating action is to the law: one object that says what it gathers, from where, how many, and to where.

An aggregating action moves several blocks at once (paper, section "SMASH gadget": "capacity-constrained aggregate
transitions"). Each kind lives in one small file and is listed in `smash.problem.actions.registry`; the law, the
files and the checker ask nothing but this interface.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any, ClassVar, Generic, NamedTuple, TypeVar

from smash.problem.model import Aggregating, Instance, PlanOptions, State

A = TypeVar("A", bound=Aggregating)


class Hop(NamedTuple):
    """One action brings up to `shared` blocks from the place `origin` to the place `target`, at `cost` in all."""

    origin: str
    target: str
    cost: int
    shared: int


class AggregatingKind(ABC, Generic[A]):
    """One kind of aggregating action.

    Attributes:
        name: its name, in plan files and options.
        action: the class of its actions.
        form: its entry in a plan file, for error messages.
        grounded: whether the poses after it are known to a planner (paper, "Partial grounding").
        needs_capacity: whether an instance has it only where its `capacities` name it.
    """

    name: ClassVar[str]
    action: type[A]
    form: ClassVar[str]
    grounded: ClassVar[bool]
    needs_capacity: ClassVar[bool] = False

    @abstractmethod
    def available(self, instance: Instance) -> bool:
        """Return whether the instance has this kind of action at all."""

    @abstractmethod
    def refusal(self, instance: Instance, options: PlanOptions, state: State, action: A) -> str | None:
        """Return why `action` is illegal in `state`, the hand being empty and the kind allowed; None: it is legal."""

    @abstractmethod
    def apply(self, state: State, action: A) -> None:
        """Carry out a legal action on `state`, in place."""

    @abstractmethod
    def legal(self, instance: Instance, options: PlanOptions, state: State) -> Iterator[A]:
        """Yield every legal action of this kind in `state`, the hand being empty and the kind allowed."""

    @abstractmethod
    def gathered(self, state: State, action: A) -> tuple[str, ...]:
        """Return the blocks that a legal action moves at once."""

    def way(self, state: State, action: A) -> tuple[str, str] | None:
        """Return the two places between which blocks travel through the air, for the cost; None: they do not."""
        return None

    @abstractmethod
    def hops(self, instance: Instance, options: PlanOptions) -> Iterator[Hop]:
        """Yield the ways on which such an action takes a block from place to place, for lower bounds."""

    @abstractmethod
    def read(self, entry: list[Any]) -> A | None:
        """Return the action of a plan file's entry that begins with the kind's name; None: malformed."""

    @abstractmethod
    def write(self, action: A) -> list[str | int]:
        """Return the plan file's entry of an action."""


def allowed(kind: AggregatingKind[Any], instance: Instance, options: PlanOptions) -> bool:
    """Return whether plans of `instance` may use actions of this kind."""
    return options.allows(kind.name) and kind.available(instance)
