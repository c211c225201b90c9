"""The marks of slots on the table, as windows, films and pictures show them."""

from __future__ import annotations

from collections.abc import Iterator

from smash.execution.scene.tabletop import Slot, Tabletop

STACK_COLOUR, BUFFER_COLOUR = (0.62, 0.70, 0.82), (0.78, 0.78, 0.76)
"""Red, green, blue in 0..1."""

Colour = tuple[float, float, float]


def slot_marks(tabletop: Tabletop) -> Iterator[tuple[Slot, list[float], Colour]]:
    """Yield each slot of a scene with half of the size [m] and the colour of its mark: stacks look unlike buffers."""
    half = [tabletop.widest * 0.575, tabletop.widest * 0.575, 0.0005]
    for number, slot in enumerate(tabletop.slots):
        yield slot, half, STACK_COLOUR if number < len(tabletop.stacks) else BUFFER_COLOUR
