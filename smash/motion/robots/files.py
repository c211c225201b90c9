"""Robot files, `smash-robot/1`, and hand files, `smash-hand/1`: TOML, strictly checked (`docs/robots.md`)."""

from __future__ import annotations

import os
from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, cast

import msgspec

from smash.problem.errors import MalformedFile
from smash.problem.files.documents import check_format, convert, parse_toml, read_bytes

ROBOT_FORMAT = "smash-robot/1"
HAND_FORMAT = "smash-hand/1"
LEVEL = 0.045
"""Height of a level of `[reach]` [m]."""

Name = Annotated[str, msgspec.Meta(pattern=r"^[A-Za-z][A-Za-z0-9_-]*\Z")]
Triple = tuple[float, float, float]
Corners = tuple[Triple, Triple]
_Positive = Annotated[float, msgspec.Meta(gt=0.0)]
_Length = Annotated[float, msgspec.Meta(gt=0.0, le=1.0)]
_Levels = Annotated[int, msgspec.Meta(ge=0, le=100)]


class Elbow(msgspec.Struct, forbid_unknown_fields=True):
    """The joint that is bent, and to which side of 0: stretched out the arm is singular."""

    joint: str
    side: Literal[-1, 1]


class ArmFile(msgspec.Struct, forbid_unknown_fields=True):
    """`[arm]` of a robot file; see `docs/robots.md`."""

    urdf: str
    base: str
    flange: str
    joints: list[str]
    ready: list[float]
    velocity: list[_Positive]
    acceleration: list[_Positive]
    jerk: list[_Positive]
    force: list[_Positive]
    lower: list[float] | None = None
    upper: list[float] | None = None
    postures: list[list[float]] = []
    elbow: Elbow | None = None
    swivel: str | None = None
    spheres: str | None = None
    padding: list[_Length] | None = None
    forearm: str | None = None
    touching: list[tuple[str, str]] = []
    apart: list[tuple[str, str]] = []


class PlaceFile(msgspec.Struct, forbid_unknown_fields=True):
    """`[mount]` of a robot file, `[tool]` of a hand file: a frame in another one [m, rad]."""

    xyz: Triple = (0.0, 0.0, 0.0)
    rpy: Triple = (0.0, 0.0, 0.0)


class ReachFile(msgspec.Struct, forbid_unknown_fields=True):
    """`[reach]` of a robot file."""

    heights: list[tuple[float, _Levels]]


class RobotFile(msgspec.Struct, forbid_unknown_fields=True):
    """A robot file."""

    format: Literal["smash-robot/1"]
    name: Name
    hand: str
    arm: ArmFile
    reach: ReachFile
    mount: PlaceFile = msgspec.field(default_factory=PlaceFile)


class BoxesFile(msgspec.Struct, forbid_unknown_fields=True):
    """`[boxes]` of a hand file."""

    palm: Corners
    finger: Corners


class HandFile(msgspec.Struct, forbid_unknown_fields=True):
    """A hand file."""

    format: Literal["smash-hand/1"]
    name: Name
    urdf: str
    root: str
    fingers: tuple[str, str]
    opening: _Length
    force: _Positive
    speed: _Positive
    tip: Annotated[float, msgspec.Meta(ge=0.0, le=0.1)]
    tool: PlaceFile
    boxes: BoxesFile | None = None


def read_robot_file(path: Path) -> RobotFile:
    """Read and check a robot file by itself; what it names is not looked at.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    file = _read(path, RobotFile, ROBOT_FORMAT)
    where, arm = str(path), file.arm
    if not 5 <= len(arm.joints) <= 8 or len(set(arm.joints)) < len(arm.joints):
        raise MalformedFile(where, f"`arm.joints`: {len(arm.joints)} names; 5 to 8, each once, are allowed")
    for key in ("ready", "velocity", "acceleration", "jerk", "force", "lower", "upper", "postures", "padding"):
        value = getattr(arm, key)
        wanted = len(arm.joints) + (key == "padding")
        rows = value if key == "postures" else [] if value is None else [value]
        for row in rows:
            if len(row) != wanted:
                raise MalformedFile(where, f"`arm.{key}`: {len(row)} numbers; {wanted} are needed, {_WANTED[key]}")
    for key, joint in (("elbow.joint", arm.elbow and arm.elbow.joint), ("swivel", arm.swivel)):
        if joint is not None and joint not in arm.joints:
            raise MalformedFile(where, f"`arm.{key}`: {joint!r} is none of `arm.joints`")
    if arm.spheres is not None and not arm.spheres.endswith(".csv"):
        raise MalformedFile(where, f"`arm.spheres`: {arm.spheres!r} is not allowed; a table's name ends in .csv")
    radii = [radius for radius, _ in file.reach.heights]
    if not radii or radii[0] < 0.0 or radii != sorted(set(radii)):
        raise MalformedFile(where, "`reach.heights`: one pair or more of distance [m] and level, the nearest first")
    return file


_PER_JOINT = "one a joint"
_WANTED = dict.fromkeys(
    ("ready", "velocity", "acceleration", "jerk", "force", "lower", "upper", "postures"), _PER_JOINT
) | {"padding": "one a link, the base first"}


def read_hand_file(path: Path) -> HandFile:
    """Read and check a hand file by itself.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    file = _read(path, HandFile, HAND_FORMAT)
    if file.fingers[0] == file.fingers[1]:
        raise MalformedFile(str(path), "`fingers`: two joints are needed, the one on the side of y > 0 first")
    for key in ("palm", "finger") if file.boxes is not None else ():
        least, greatest = getattr(file.boxes, key)
        if any(low >= high for low, high in zip(least, greatest, strict=True)):
            raise MalformedFile(str(path), f"`boxes.{key}`: the least corner, then the greatest")
    return file


_File = TypeVar("_File", RobotFile, HandFile)


def _read(path: Path, kind: type[_File], format_: str) -> _File:
    where = os.fspath(path)
    document: Any = parse_toml(read_bytes(path, "robot files"), where)
    check_format(document, where, format_)
    file = cast(_File, convert(document, kind, where))
    for key in _endless(document):
        raise MalformedFile(where, f"`{key}`: finite numbers are allowed")
    return file


def _endless(value: Any, key: str = "") -> Iterator[str]:
    """Yield the keys at which a document has numbers that are infinite or none."""
    if isinstance(value, dict):
        for name, part in value.items():
            yield from _endless(part, f"{key}.{name}" if key else name)
    elif isinstance(value, list):
        for part in value:
            yield from _endless(part, key)
    elif isinstance(value, float) and not isfinite(value):
        yield key
