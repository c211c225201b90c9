"""What goes wrong in the scene, beside what the arm cannot do (`smash.motion.errors`)."""

from __future__ import annotations

from smash.problem.errors import ExecutionFailure


class Slip(ExecutionFailure):
    """The block is not, or no longer, between the fingers."""

    failure = "slip"


class Fell(ExecutionFailure):
    """A block stands elsewhere than the action leaves it: a pile fell, or a topple took other blocks than it should."""

    failure = "fell"


class OutOfReach(ExecutionFailure):
    """A toppled block lies where the arm cannot grasp it from above."""

    failure = "out of reach"


class Blind(ExecutionFailure):
    """A block is not known well enough for the hand to come down around it; more plans would not help."""

    failure = "blind"


class NotAtGoal(ExecutionFailure):
    """All actions were carried out, and the settled blocks do not fulfil the goal."""

    failure = "not at goal"
