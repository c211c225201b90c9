"""Poses in a file: an observer that tells what was recorded, and one that records what another tells.

The file, `smash-poses/1`, has a look a line, in the order of time, each a JSON object: `format`; `time` [s] from the
episode's beginning; `blocks`, name to `[x, y, z, qx, qy, qz, qw]` [m, unit quaternion] in the frame of the robot's
base; likewise `carriers`; and `spread`, name to how far a side of the block may be from there, a standard deviation
[m], for those that are not seen exactly. The first look has all blocks and carriers of the instance; a later one may
leave out what it did not see. Blocks of no such name are not looked at.
"""

from __future__ import annotations

import os
from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from math import hypot, isfinite
from pathlib import Path
from typing import Final, Protocol

import msgspec
import numpy as np

from smash.execution.observer import Eyes, Observer
from smash.execution.physics.world import World
from smash.execution.scene.block_pose import BlockPose, quaternion_of
from smash.execution.scene.noise import Chance
from smash.problem.errors import MalformedFile
from smash.problem.files.documents import check_format, convert, parse_json, read_text, write_text
from smash.problem.model import Instance

POSES_FORMAT: Final = "smash-poses/1"
UNIT_WITHIN = 1e-3
"""A quaternion's length differs from 1 by no more than this."""
FURTHEST = 1e6
"""Nothing is further from the robot's base, along an axis [m]: what fell off the table falls on."""

SevenNumbers = tuple[float, float, float, float, float, float, float]


class Look(
    msgspec.Struct, kw_only=True, tag_field="format", tag=POSES_FORMAT, forbid_unknown_fields=True, omit_defaults=True
):
    """What was seen at one moment: a line of the file."""

    time: float
    blocks: dict[str, SevenNumbers]
    carriers: dict[str, SevenNumbers] = {}
    spread: dict[str, float] = {}


class Clock(Protocol):
    """What has a time, as a simulated world has."""

    time: float
    """[s] from the beginning of the episode."""


class RecordedPoses:
    """Tells at every moment what the last look of a file has seen: an `Observer`.

    Args:
        looks: In the order of time; the first one has everything.
        clock: Whose time it is; without one the last look is the present.
    """

    def __init__(self, looks: Sequence[Look], clock: Clock | None = None) -> None:
        self._clock = clock
        self._times = [look.time for look in looks]
        self._spreads = [look.spread for look in looks]
        self._blocks = _known([look.blocks for look in looks])
        self._carriers = _known([look.carriers for look in looks])

    @property
    def exact(self) -> bool:
        """Whether the file says of no block that it may be elsewhere."""
        return not any(self._spreads)

    def blocks(self) -> dict[str, BlockPose]:
        """Poses of all blocks: where each was seen last."""
        return dict(self._blocks[self._now()])

    def carriers(self) -> dict[str, BlockPose]:
        """Poses of all carriers, likewise."""
        return dict(self._carriers[self._now()])

    def spread(self, block: str) -> float:
        """How far a side of a block may be from where it was seen, a standard deviation [m]."""
        return self._spreads[self._now()].get(block, 0.0)

    def forget(self, blocks: Iterable[str]) -> None:
        """Do nothing: a record is what it is."""

    def _now(self) -> int:
        """The last look until now; before the first one, that."""
        if self._clock is None:
            return len(self._times) - 1
        return max(0, bisect_right(self._times, self._clock.time + 1e-9) - 1)


class Witness:
    """Tells what another observer tells, and writes down each look.

    Args:
        other: The eyes.
        world: Whose time it is.
        looks: Where the looks are put; of several at one moment the last stays.
    """

    def __init__(self, other: Observer, world: World, looks: list[Look]) -> None:
        self._other, self._world, self._looks = other, world, looks

    @property
    def exact(self) -> bool:
        """Whether the other one is."""
        return self._other.exact

    def blocks(self) -> dict[str, BlockPose]:
        """What the other one tells, written down."""
        blocks = self._other.blocks()
        spread = {} if self.exact else {block: self._other.spread(block) for block in blocks}
        look = Look(time=self._world.time, blocks=_rows(blocks), carriers=_rows(self.carriers()), spread=spread)
        if self._looks and self._looks[-1].time == look.time:
            self._looks.pop()
        self._looks.append(look)
        return blocks

    def carriers(self) -> dict[str, BlockPose]:
        """What the other one tells."""
        return self._other.carriers()

    def spread(self, block: str) -> float:
        """What the other one tells [m]."""
        return self._other.spread(block)

    def forget(self, blocks: Iterable[str]) -> None:
        """Have the other one forget."""
        self._other.forget(blocks)


def witnessed(eyes: Eyes, looks: list[Look]) -> Eyes:
    """The same eyes, with all their looks put into `looks`."""

    def opened(world: World, chance: Chance) -> Observer:
        return Witness(eyes(world, chance), world, looks)

    return opened


def recorded_eyes(path: str | os.PathLike[str], instance: Instance) -> Eyes:
    """Eyes that tell what a file says of the blocks and carriers of an instance.

    Raises:
        MalformedFile: where it is no file of poses, or its first look has not all of them.
    """
    looks, carriers = read_looks(path), [carrier.name for carrier in instance.carriers]
    for kind, names in (("blocks", instance.blocks), ("carriers", carriers)):
        missing = [name for name in names if name not in getattr(looks[0], kind)]
        if missing:
            raise MalformedFile(
                os.fspath(path), f"line 1: `{kind}` has no {missing[0]!r}; the first look has all of the instance"
            )
    chosen = [
        Look(
            time=look.time,
            blocks={name: look.blocks[name] for name in instance.blocks if name in look.blocks},
            carriers={name: look.carriers[name] for name in carriers if name in look.carriers},
            spread=look.spread,
        )
        for look in looks
    ]

    def opened(world: World, chance: Chance) -> Observer:
        return RecordedPoses(chosen, world)

    return opened


def read_looks(path: str | os.PathLike[str]) -> list[Look]:
    """The looks of a file.

    Raises:
        MalformedFile: with the line that is no look, or before whose time another one lies.
    """
    looks: list[Look] = []
    # Not `splitlines`, which also ends a line at characters that a name may have.
    for number, line in enumerate(read_text(path).removesuffix("\n").split("\n"), start=1):
        where = f"{os.fspath(path)}: line {number}"
        document = parse_json(line, where)
        check_format(document, where, POSES_FORMAT)
        look: Look = convert(document, Look, where)
        _check(look, where)
        if looks and look.time < looks[-1].time:
            raise MalformedFile(where, f"`time`: {look.time:g} is before the {looks[-1].time:g} of the line above")
        looks.append(look)
    return looks


def write_looks(path: Path, looks: Iterable[Look]) -> None:
    """Write looks as `read_looks` reads them.

    Raises:
        MalformedFile: where the file cannot be written.
    """
    write_text(path, "".join(f"{msgspec.json.encode(look).decode()}\n" for look in looks))


def _check(look: Look, where: str) -> None:
    """Refuse numbers that are none or of no table, and quaternions that are of no length 1."""
    for kind, poses in (("blocks", look.blocks), ("carriers", look.carriers)):
        for name, pose in poses.items():
            if not all(abs(number) <= FURTHEST for number in pose):
                raise MalformedFile(
                    where, f"`{kind}`: {name!r}: numbers from -{FURTHEST:g} to {FURTHEST:g} are allowed"
                )
            if abs(hypot(*pose[3:]) - 1.0) > UNIT_WITHIN:
                raise MalformedFile(where, f"`{kind}`: {name!r}: the last four numbers are no unit quaternion")
    for name, spread in look.spread.items():
        if not 0.0 <= spread <= FURTHEST:
            raise MalformedFile(where, f"`spread`: {name!r}: {spread!r} is not allowed; a number, 0 to {FURTHEST:g}")
    if not isfinite(look.time):
        raise MalformedFile(where, f"`time`: {look.time!r} is not allowed; a finite number")


def _known(seen: Iterable[Mapping[str, SevenNumbers]]) -> list[dict[str, BlockPose]]:
    """After each look, where everything was seen last."""
    known: list[dict[str, BlockPose]] = []
    for poses in seen:
        known.append({**(known[-1] if known else {}), **{name: _pose(row) for name, row in poses.items()}})
    return known


def _pose(row: SevenNumbers) -> BlockPose:
    from scipy.spatial.transform import Rotation

    return BlockPose(np.array(row[:3]), Rotation.from_quat(row[3:]).as_matrix())


def _rows(poses: Mapping[str, BlockPose]) -> dict[str, SevenNumbers]:
    rows = {name: [*map(float, pose.position), *quaternion_of(pose.rotation)] for name, pose in poses.items()}
    return {name: (x, y, z, a, b, c, d) for name, (x, y, z, a, b, c, d) in rows.items()}
