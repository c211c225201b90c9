"""What a guardian guards: work that is data, done in a process of its own, within limits."""

from __future__ import annotations

from pkgutil import resolve_name
from typing import Any, ClassVar, Protocol, Self, cast


class Work(Protocol):
    """One piece of work.

    Attributes:
        done_by: `module:function` that does it in its own process, called with the work and the pipe on which it
            speaks; it does not return.
        loaded_by: `module:function` that a fork server calls once, before it forks for such work.
    """

    done_by: ClassVar[str]
    loaded_by: ClassVar[str]

    @property
    def budget(self) -> float:
        """Seconds of wall time from the line `solving` on."""

    @property
    def memory(self) -> int:
        """Memory limit of its whole process tree [MiB]."""

    def document(self) -> dict[str, Any]:
        """Return it as JSON data."""

    @classmethod
    def from_document(cls, document: dict[str, Any]) -> Self:
        """Build it from its JSON data."""


def work_document(work: Work) -> dict[str, Any]:
    """Return work as JSON data that says of what kind it is."""
    kind = type(work)
    return {"kind": f"{kind.__module__}:{kind.__qualname__}", "work": work.document()}


def work_from_document(document: dict[str, Any]) -> Work:
    """Build work of any kind from its JSON data."""
    return cast(Work, resolve_name(document["kind"]).from_document(document["work"]))
