"""What other packages add to the aggregating actions by entry points: their law, parts of the gadget and PDDL, motions.

A fault of another package is one line on standard error, and leaves out what it concerns.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from typing import Any

from smash.problem.entry_points import entry_points_of


def added(group: str, kind: type) -> Iterator[Any]:
    """Yield one `kind` for each class that an entry point of `group` names."""
    return _faultless(group, kind, lambda named: named())


def added_classes(group: str, kind: type) -> Iterator[Any]:
    """Yield the classes themselves that the entry points of `group` name, each of kind `kind`."""
    return _faultless(group, kind, lambda named: named)


def _faultless(group: str, kind: type, take: Callable[[Any], Any]) -> Iterator[Any]:
    for entry in entry_points_of(group):
        try:
            thing = take(entry.load())
            _require(thing, kind)
        except Exception as error:  # another package's fault must not stop this one
            reason = " ".join(str(error).split()) or type(error).__name__
            print(f"smash: {group} {entry.name!r} of another package cannot be loaded: {reason}", file=sys.stderr)
        else:
            yield thing


def _require(thing: Any, kind: type) -> None:
    """Raise `TypeError` unless it is a `kind`, or a class of it, with all that such a one has."""
    named = thing if isinstance(thing, type) else type(thing)
    if not issubclass(named, kind):
        raise TypeError(f"{named.__name__} is no {kind.__name__}")
    lacking = set(getattr(named, "__abstractmethods__", ()))
    lacking |= {name for name in kind.__annotations__ if not hasattr(thing, name)}
    if lacking:
        raise TypeError(f"{named.__name__} lacks {', '.join(sorted(lacking))}")
