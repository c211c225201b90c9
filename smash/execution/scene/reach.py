"""How high a pile may be at which distance from the arm's base.

Measured: at each distance, the greatest level to which the hand can bring a block straight down from above.
"""

from __future__ import annotations

LEVEL = 0.045
"""Heights are counted in levels of so much [m]."""
HEIGHTS: tuple[tuple[float, int], ...] = ((0.30, 12), (0.65, 12), (0.70, 10), (0.75, 8))
"""Distance from the base [m], and the levels that a pile may have there."""


def highest(radius: float) -> float:
    """How high a pile may be that is worked on from above at this distance from the base [m]; 0: out of reach.

    Between two measured distances it is the lesser of theirs.
    """
    inner = [levels for known, levels in HEIGHTS if known <= radius + 1e-9]
    outer = [levels for known, levels in HEIGHTS if known >= radius - 1e-9]
    return LEVEL * min(inner[-1], outer[0]) if inner and outer else 0.0
