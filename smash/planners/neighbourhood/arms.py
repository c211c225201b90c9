"""Which neighbourhood is tried next: what has paid off; in the long run all get efforts of the same order."""

from __future__ import annotations

import random
from dataclasses import dataclass

FADING = 0.9
"""What is left of an arm's gains each time that it is tried."""


@dataclass(slots=True)
class Arm:
    """A kind of neighbourhood with its size.

    Attributes:
        size: steps of a window; choices of a greedy tail that are disturbed.
        width: of the beam that plans a window; 0 for a greedy tail.
        effort: what has been spent on it, and once more what it is thought to take [about seconds].
        gain: what it saved lately.
        gathers: whether the steps of its windows are gathered from a longer stretch.
    """

    size: int
    width: int
    effort: float
    gain: float = 0.0
    gathers: bool = False

    def paid(self, gain: int, effort: float) -> None:
        """Note what came of it."""
        self.gain = FADING * self.gain + gain
        self.effort += effort


def choose(arms: list[Arm], draw: random.Random) -> Arm:
    """Draw an arm, the likelier the more it saved for what was spent on it."""
    return max(arms, key=lambda arm: draw.random() * (1.0 + arm.gain) / arm.effort)
