"""Why an execution fails: one family, each member with the failure's name (issue names: IK, no motion, slip, ...)."""

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
