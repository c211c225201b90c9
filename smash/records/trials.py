"""A trial of a topple: `smash-topple-trial/1`, one line of `trials.jsonl`."""

from __future__ import annotations

from typing import Final, Literal

import msgspec

from smash.records.episodes import ROBOT
from smash.records.record import Record

TRIAL_FORMAT: Final = "smash-topple-trial/1"
Key = tuple[str, int, int, int, int]
"""What tells a trial from the others: the scene's fingerprint (and the engine where it is not PyBullet), stack, height
of the cut, number falling, seed."""


def simulated(layout: str, engine: str) -> str:
    """Return what a scene of this fingerprint is called in the keys of an engine's trials."""
    return layout if engine == "pybullet" else f"{layout}/{engine}"


class Landing(msgspec.Struct, frozen=True):
    """Where one block came to rest, in the push's frame, from the pile's middle [m]; whether it can be grasped.

    `seconds` is what the pick of it would take from where the push has left the arm, None where that is not known.
    """

    level: int
    along: float
    aside: float
    graspable: bool
    seconds: float | None = None


class Trial(Record, kw_only=True, frozen=True):
    """One topple.

    Attributes:
        layout: The scene's fingerprint.
        engine: What simulated it; a record that does not say so is from when there was PyBullet alone.
        robot: What toppled; a record that does not say so is from when there was the Panda alone.
        stack: Index of the scene's stack.
        height: Lowest level that falls, 1 is the bottom.
        falling: Number of blocks that fall.
        seed: Of the start poses.
        moved: Largest displacement of a block below the cut [m].
        stands: Whether the lower part still stands at its place, by the law's reading of the scene.
        landings: One per toppled block, from the cut upward; empty where no push was found.
        problem: Why there was no push, or nothing.
        seconds: Simulated time of the topple from the arm's ready pose until all lies still [s]; None in old records.
    """

    format: Literal["smash-topple-trial/1"] = TRIAL_FORMAT
    scene: str
    layout: str = ""
    engine: str = "pybullet"
    robot: str = ROBOT
    stack: int
    height: int
    falling: int
    seed: int
    moved: float = 0.0
    stands: bool = False
    landings: tuple[Landing, ...] = ()
    problem: str = ""
    seconds: float | None = None

    @property
    def key(self) -> Key:
        """What tells a trial from the others."""
        return simulated(self.layout, self.engine), self.stack, self.height, self.falling, self.seed

    @property
    def success(self) -> bool:
        """Whether the plan could go on as the law says."""
        return self.stands and bool(self.landings) and all(landing.graspable for landing in self.landings)
