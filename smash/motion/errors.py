"""Why an execution fails: one family, each member with the failure's name."""

from __future__ import annotations

from typing import ClassVar

from smash.problem.errors import SmashError


class ExecutionFailure(SmashError):
    """A step of an episode that could not be carried out; `failure` is its name in the records."""

    exit_code = 5
    failure: ClassVar[str] = "execution"


class NoIk(ExecutionFailure):
    """No joint configuration within the limits brings the tool to the asked pose."""

    failure = "IK"


class NoMotion(ExecutionFailure):
    """No collision-free motion was found; the message says what is in the way where that is known."""

    failure = "no motion"


class Slip(ExecutionFailure):
    """The block is not, or no longer, between the fingers."""

    failure = "slip"


class Fell(ExecutionFailure):
    """A block stands elsewhere than the action leaves it: a pile fell, or a topple took other blocks than it should."""

    failure = "fell"


class OutOfReach(ExecutionFailure):
    """A toppled block lies where the arm cannot grasp it from above."""

    failure = "out of reach"


class NotAtGoal(ExecutionFailure):
    """All actions were carried out, and the settled blocks do not fulfil the goal."""

    failure = "not at goal"
