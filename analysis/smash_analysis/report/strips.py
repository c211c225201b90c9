"""Paired differences as small pictures for a table: dots for instances, mean, interval or range; one scale for all."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from smash.problem.words import counted
from smash_analysis.statistics.intervals import Paired, is_range

WIDTH, HEIGHT, MARGIN = 190.0, 22.0, 6.0
"""Size of a strip, and the room left and right of its scale [px]."""


def strips(pairs: Sequence[Paired]) -> list[str]:
    """Return an inline SVG per comparison, empty where nothing is common; all are on one scale."""
    values = [float(value) for pair in pairs for value in pair.differences]
    low, high = min([0.0, *values]), max([1.0, *values])
    return [_strip(pair, low, high) if pair.units else "" for pair in pairs]


def _strip(pair: Paired, low: float, high: float) -> str:
    def at(value: float) -> float:
        return MARGIN + (value - low) / (high - low) * (WIDTH - 2 * MARGIN)

    middle = HEIGHT / 2
    left, right = pair.interval
    spread = "range" if is_range(pair.units) else "95 % interval"
    words = f"mean {pair.mean:.1f}, {spread} {left:.1f} to {right:.1f}; {counted(pair.units, 'instance')}"
    dots = [
        f'<circle cx="{at(value):.1f}" cy="{middle:.1f}" r="{min(5.0, 2.0 + 0.4 * count):.1f}"/>'
        for value, count in sorted(Counter(pair.differences.tolist()).items())
    ]
    return (
        f'<svg class="strip" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img"><title>{words}</title>'
        f'<path class="zero" d="M{at(0):.1f} 2V{HEIGHT - 2:g}"/><g class="dots">{"".join(dots)}</g>'
        f'<path class="interval" d="M{at(left):.1f} {middle:g}H{at(right):.1f}"/>'
        f'<path class="mean" d="M{at(pair.mean):.1f} {middle - 6:g}v12"/></svg>'
    )
