"""Scene files written: the document of one, with other slots, as TOML."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from math import degrees, pi
from typing import Any

from smash.execution.scene.scene_file import SCENE_FORMAT
from smash.execution.scene.tabletop import Slot

DIGITS = 4
"""Of radii [m] and angles [degrees]."""


def with_slots(
    document: Mapping[str, Any], name: str, stacks: Sequence[Slot], buffers: Sequence[Slot]
) -> dict[str, Any]:
    """Return a scene's document with these slots and another name; stations, which have no place any more, go.

    Args:
        document: A `smash-scene/1` document.
        name: What the new scene is called.
        stacks: Slots of stacks.
        buffers: Slots of buffers.
    """
    kept = {key: value for key, value in document.items() if key not in ("stations", "tray")}
    slots = {"stacks": [_entry(slot, True) for slot in stacks], "buffers": [_entry(slot, False) for slot in buffers]}
    return {"format": SCENE_FORMAT, **kept, "name": name, **slots}


def scene_toml(document: Mapping[str, Any], comment: str = "") -> str:
    """Return a scene's document as TOML, which `read_scene` reads; each line of `comment` stands on top.

    What is null in JSON is left out, which means the same.
    """
    lines = [f"# {line}" for line in comment.splitlines()]
    lines += _lines({key: value for key, value in document.items() if not _is_table(value)})
    for key, value in document.items():
        if isinstance(value, Mapping):
            lines += ["", f"[{_key(key)}]", *_lines(value)]
        elif _is_table(value):
            for entry in value:
                lines += ["", f"[[{_key(key)}]]", *_lines(entry)]
    return "\n".join(lines) + "\n"


def _entry(slot: Slot, stack: bool) -> dict[str, Any]:
    angle = degrees((slot.angle + pi) % (2 * pi) - pi)
    entry: dict[str, Any] = {"radius": round(slot.radius, DIGITS), "angle": round(angle, DIGITS)}
    if stack:
        entry["topple"] = list(slot.directions)
    if slot.highest is not None:
        entry["highest"] = slot.highest
    if slot.falling:
        entry["falling"] = slot.falling
    return entry


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping) or bool(
        isinstance(value, list) and value and all(isinstance(entry, Mapping) for entry in value)
    )


def _lines(table: Mapping[str, Any]) -> list[str]:
    return [f"{_key(key)} = {_value(value)}" for key, value in table.items() if value is not None]


def _key(key: str) -> str:
    bare = key.isascii() and key.replace("-", "").replace("_", "").isalnum()
    return key if bare else _text(key)


def _value(value: Any) -> str:
    """A TOML value: JSON's, but for tables within a line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(_lines(value)) + " }" if value else "{}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    return _text(value) if isinstance(value, str) else json.dumps(value)


def _text(text: str) -> str:
    """A TOML string: JSON's escapes are TOML's, except for what lies beyond 16 bits, which stands as it is."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
