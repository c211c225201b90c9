"""Equal parts of many records held once: most of what the runs of a sweep say is said by the others too."""

from __future__ import annotations

import gc
from collections.abc import Hashable, Iterator
from contextlib import contextmanager
from typing import Any, Generic

from msgspec.structs import force_setattr

from smash.records.files import R

OFTEN_EQUAL = ("instance_document", "versions", "machine", "commit", "verdict", "budgets")
"""Fields whose values few records have for themselves alone."""
MOST_KNOWN = 64
"""Different values of a field that are compared with; more would cost more time than they save memory."""


@contextmanager
def kept_objects() -> Iterator[None]:
    """While many objects are made that all are kept, Python does not look again and again for some that are not."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


class Sharing(Generic[R]):
    """Makes records of one file hold equal parts together; what they say is not changed (but 1 for an equal 1.0)."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, Hashable], list[Any]] = {}
        self._actions: dict[tuple[Any, ...], Any] = {}

    def __call__(self, record: R) -> R:
        """Return the record, its parts replaced by equal ones of earlier records."""
        subject = getattr(record, "instance_hash", None)
        for name in OFTEN_EQUAL:
            value = getattr(record, name, None)
            if value is not None:
                force_setattr(record, name, self._same(name, subject if name == "instance_document" else None, value))
        actions = getattr(record, "actions", None)
        if actions is not None:
            known = self._actions
            force_setattr(record, "actions", [known.setdefault(tuple(action), action) for action in actions])
        return record

    def _same(self, name: str, subject: Hashable, value: Any) -> Any:
        known = self._known.setdefault((name, subject), [])
        for other in known:
            if other == value:
                return other
        if len(known) < MOST_KNOWN:
            known.append(value)
        return value
