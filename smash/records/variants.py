"""Variants: what a plan may use, as experiments and records name it."""

from __future__ import annotations

import re
from functools import lru_cache

from smash.problem.actions.registry import FAMILY
from smash.problem.model import PlanOptions

FURTHER = tuple(name for name in FAMILY if name != "topple")
"""Aggregating actions that a variant can leave out by `-no-NAME`."""


@lru_cache(256)
def variant_options(variant: str) -> PlanOptions | None:
    """Return what a variant's name allows a plan to do, or None where it is no variant."""
    parts = re.fullmatch(
        rf"(topple|no-topple|max-topple-([1-9][0-9]{{0,5}}))((?:-no-(?:{'|'.join(FURTHER)}))*)", variant
    )
    if parts is None:
        return None
    without = tuple(parts[3].split("-no-")[1:])
    return PlanOptions(parts[1] != "no-topple", int(parts[2]) if parts[2] else None, without=without)
