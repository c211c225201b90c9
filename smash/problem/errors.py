"""The one family of errors that a user can cause; each message is one line: what, where, what is allowed."""

from __future__ import annotations

from typing import ClassVar


class SmashError(Exception):
    """Base of all errors that end in one clear line on stderr and an exit code."""

    exit_code = 2


class MalformedFile(SmashError):
    """A file that is not what its format says."""

    def __init__(self, where: str, problem: str) -> None:
        self.where = where
        self.problem = problem
        super().__init__(f"{where}: {problem}")


class RefusedCertificate(MalformedFile):
    """A certificate that does not prove what it says."""

    exit_code = 3

    def __init__(self, problem: str) -> None:
        super().__init__("certificate", problem)


class RefusedPlan(SmashError):
    """A well-formed plan that the law refuses, given where a legal one is needed."""

    exit_code = 3


class Infeasible(SmashError):
    """A problem without a plan, said where no instance can be made of it: the format cannot hold what it asks for."""

    exit_code = 3


class IllegalAction(SmashError):
    """An action that the law does not allow in the state at hand."""

    exit_code = 3


class ExecutionFailure(SmashError):
    """An action that the robot could not carry out; `failure` is its name in the records."""

    exit_code = 5
    failure: ClassVar[str] = "execution"


class Unsupported(SmashError):
    """A planner was asked for what it says it cannot do, or its engine is not installed."""

    exit_code = 6


class Interrupted(SmashError):
    """Long work was stopped by its user; what had finished is recorded."""

    exit_code = 130


class PlannerCrashed(SmashError):
    """A planner ended abnormally or hit its memory limit."""

    exit_code = 7


class PlannerOutOfMemory(PlannerCrashed, MemoryError):
    """A planner hit its memory limit without a plan; a `MemoryError` too, so that runners tell it from a crash."""
