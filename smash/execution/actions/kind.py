"""What an aggregating action is to the arm: one object that plans it, foresees its outcome and checks what came of it.

Each kind lives in one small file and is listed in the `registry` beside it, as its law is in
`smash.problem.actions.registry`; grounding, performing and recovery ask nothing but this interface.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar, Generic, TypeVar

from smash.execution.actions.arm_motions import ArmMotions, Segment
from smash.execution.scene.area import Area
from smash.execution.scene.geometry import Geometry
from smash.motion.poses import Vector
from smash.problem.model import Aggregating, State

A = TypeVar("A", bound=Aggregating)


class AggregateMotion(ABC, Generic[A]):
    """How the arm carries out one kind of aggregating action.

    Attributes:
        action: The class of its actions.
        level: Whether it keeps level what the hand carries (`smash.motion.level`): not every arm can.
    """

    action: type[A]
    level: ClassVar[bool] = False

    @abstractmethod
    def plan(self, arm: ArmMotions, start: Vector, action: A, state: State, where: Geometry) -> list[Segment]:
        """Plan the motions of a legal action.

        Args:
            arm: Plans motions.
            start: Where the arm is [rad], shape (n,).
            action: The action.
            state: The law's state before it.
            where: The poses that are known then.

        Raises:
            ExecutionFailure: where there is no motion for it.
        """

    @abstractmethod
    def foresee(self, arm: ArmMotions, action: A, state: State, where: Geometry) -> None:
        """Change `where` as the action will; poses that nobody can foresee are taken out."""

    @abstractmethod
    def places(self, action: A) -> tuple[str, ...]:
        """Return the places where a loose block would be in the action's way."""

    def areas(self, arm: ArmMotions, action: A, state: State, where: Geometry) -> tuple[Area, ...]:
        """Return where the blocks may be afterwards whose poses nobody can foresee.

        Args:
            arm: Plans motions.
            action: The action.
            state: The law's state before it.
            where: The poses that are known then.
        """
        return ()

    def motions(self, action: A, state: State) -> int:
        """Return how many motions the action is meant to take from the law's state before it."""
        return 1

    def unfinished(self, action: A, state: State) -> bool:
        """Return whether the state after the motion asks for another one of the same action."""
        return False

    def grasped(self, action: A, state: State) -> str | None:
        """Return the block that the hand takes hold of, which has to be known well; None where it is none."""
        return None

    def anchor(self, action: A, state: State, where: Geometry) -> Vector | None:
        """The position of what the hand takes hold of [m], shape (3,): a motion is good while it is there."""
        return None
