"""An action of a plan or an episode as the columns of a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

FIELDS: Mapping[str, tuple[str, ...]] = {
    "pick": ("block", "location"),
    "place": ("block", "location"),
    "topple": ("location", "height"),
    "carry": ("carrier", "location"),
    "lift": ("location", "height", "target"),
}
"""Kind of action -> what its fields are, in the order in which records list them.

`location` is a pick's source, a place's target, the stack that is toppled or lifted off, the station that a carrier
goes to; `height` is that of the lowest block that moves (1 is the bottom).
"""
ACTION_COLUMNS: Mapping[str, str] = {
    **dict.fromkeys(("action", "block", "location"), "string"),
    "height": "Int64",
    **dict.fromkeys(("carrier", "target"), "string"),
}
"""Columns that name an action, and their types; those that its kind does not have are null."""


def named(action: Sequence[str | int]) -> dict[str, str | int | None]:
    """Return the columns of an action; only the name is known of another package's, and of one that is malformed."""
    kind, *values = action or ("",)
    fields = FIELDS.get(str(kind), ())
    fits = [type(value) for value in values] == [int if field == "height" else str for field in fields]
    known = dict(zip(fields, values, strict=True)) if fits else {}
    return {**dict.fromkeys(ACTION_COLUMNS), "action": str(kind), **known}
