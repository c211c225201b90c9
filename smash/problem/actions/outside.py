"""What other packages add to the family by entry points."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib.metadata import entry_points
from typing import Any


def added(group: str) -> Iterator[Any]:
    """Yield what the entry points of `group` make when they are called; one that fails is named and left out."""
    for entry in entry_points(group=group):
        try:
            yield entry.load()()
        except Exception as error:  # another package's fault must not stop this one
            print(f"smash: {group} {entry.name!r} of another package cannot be loaded: {error}", file=sys.stderr)
