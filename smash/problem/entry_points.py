"""What installed packages offer by entry points, read once: reading it takes longer than many a plan."""

from __future__ import annotations

import sys
from functools import lru_cache
from importlib.metadata import EntryPoints, entry_points
from typing import Any


def entry_points_of(group: str) -> EntryPoints:
    """Return the entry points of a group."""
    chosen: EntryPoints = _offered(tuple(sys.path)).select(group=group)
    return chosen


@lru_cache(maxsize=1)
def _offered(path: tuple[str, ...]) -> Any:
    """Return what all packages on the search path offer; `path` tells whether it is still the same."""
    return entry_points()
