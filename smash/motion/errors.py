"""What the arm cannot do."""

from __future__ import annotations

from smash.problem.errors import ExecutionFailure


class NoIk(ExecutionFailure):
    """No joint configuration within the limits brings the tool to the asked pose."""

    failure = "IK"


class NoMotion(ExecutionFailure):
    """No collision-free motion was found; the message says what is in the way where that is known."""

    failure = "no motion"
