"""Scene files, `smash-scene/1`: sizes of blocks, friction, speed and layout, in TOML or JSON, checked strictly.

A file that says `base = "default"` has from the default scene what it does not hold itself.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from math import hypot, radians
from pathlib import Path
from typing import Annotated, Any, Literal, cast

import msgspec

from smash.execution.scene.block_size import FOOTPRINTS, HEIGHTS, BlockSize
from smash.execution.scene.noise import checked_noise, parse_noise
from smash.execution.scene.tabletop import DIRECTIONS, SLOWEST, Friction, Noise, Slot, Tabletop
from smash.execution.scene.tray import Tray
from smash.problem.errors import MalformedFile, SmashError
from smash.problem.files.documents import check_format, convert, parse_json, parse_toml, read_bytes

SCENE_FORMAT = "smash-scene/1"
DEFAULT_SCENE = Path(__file__).parent / "default.toml"
LEAST_APART = 1.5
"""Middles of two slots are so many sides apart, or the file is refused."""

MOST_BLOCKS = 100
"""The most blocks of a pile, or of a topple, that a slot is made for: more than any arm reaches."""

HEAVIEST = 1.0
"""The most that a block weighs [kg]."""

_Share = Annotated[float, msgspec.Meta(ge=SLOWEST, le=1.0)]
_Count = Annotated[int, msgspec.Meta(ge=1, le=MOST_BLOCKS)]
_Coefficient = Annotated[float, msgspec.Meta(gt=0.0, le=2.0)]


class _BlockFile(msgspec.Struct, forbid_unknown_fields=True):
    side: Annotated[float, msgspec.Meta(ge=0.03, le=0.06)] = 0.045
    mass: Annotated[float, msgspec.Meta(gt=0.0, le=1.0)] = 0.1
    footprint: float | None = None
    height: float | None = None


class _SizeFile(msgspec.Struct, forbid_unknown_fields=True):
    footprint: float | None = None
    height: float | None = None
    mass: float | None = None


class _FrictionFile(msgspec.Struct, forbid_unknown_fields=True):
    block: _Coefficient = 0.45
    table: _Coefficient = 0.9
    finger: _Coefficient = 1.0


class _SpeedFile(msgspec.Struct, forbid_unknown_fields=True):
    velocity: _Share = 0.5
    acceleration: _Share = 0.25


class _NoiseFile(msgspec.Struct, forbid_unknown_fields=True):
    pose: float = 0.0
    yaw: float = 0.0
    camera: float = 0.0
    placement: float = 0.0
    friction: float = 0.0
    mass: float = 0.0
    size: float = 0.0


class _SlotFile(msgspec.Struct, forbid_unknown_fields=True):
    radius: Annotated[float, msgspec.Meta(ge=0.25, le=0.75)]
    angle: Annotated[float, msgspec.Meta(ge=-180.0, le=180.0)]


class _BufferFile(_SlotFile, forbid_unknown_fields=True):
    highest: _Count | None = None


class _StackFile(_SlotFile, forbid_unknown_fields=True):
    topple: list[Literal["counter-clockwise", "clockwise", "outward", "inward"]]
    highest: _Count | None = None
    falling: _Count | None = None


class _TrayFile(msgspec.Struct, forbid_unknown_fields=True):
    rows: Annotated[int, msgspec.Meta(ge=1, le=4)] = 1
    board: Annotated[float, msgspec.Meta(ge=0.004, le=0.03)] = 0.010
    rim: Annotated[float, msgspec.Meta(ge=0.0, le=0.008)] = 0.006
    post: Annotated[float, msgspec.Meta(ge=0.01, le=0.05)] = 0.022
    mass: Annotated[float, msgspec.Meta(gt=0.0, le=1.0)] = 0.25
    friction: _Coefficient = 0.9


class _SceneFile(msgspec.Struct, forbid_unknown_fields=True):
    format: Literal["smash-scene/1"]
    name: str
    stacks: list[_StackFile]
    base: Literal["default"] | None = None
    engine: Literal["pybullet", "mujoco"] | None = None
    robot: str | None = None
    block: _BlockFile = msgspec.field(default_factory=_BlockFile)
    blocks: dict[str, _SizeFile] = {}
    friction: _FrictionFile = msgspec.field(default_factory=_FrictionFile)
    speed: _SpeedFile = msgspec.field(default_factory=_SpeedFile)
    buffers: list[_BufferFile] = []
    tray: _TrayFile = msgspec.field(default_factory=_TrayFile)
    stations: list[_SlotFile] = []
    noise: _NoiseFile = msgspec.field(default_factory=_NoiseFile)


def read_scene(path: str | os.PathLike[str]) -> Tabletop:
    """Read and check a scene file: TOML where its name ends in `.toml`, else JSON.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    return scene_from_document(scene_document(path), os.fspath(path))


def scene_document(path: str | os.PathLike[str]) -> Any:
    """Return what stands in a scene file, as `scene_from_document` checks it.

    Raises:
        MalformedFile: where it cannot be read, or is neither TOML nor JSON, as its name says.
    """
    where, content = os.fspath(path), read_bytes(path, "scene files")
    return parse_toml(content, where) if where.endswith(".toml") else parse_json(content, where)


@cache
def default_scene() -> Tabletop:
    """The scene that is used where none is named."""
    return read_scene(DEFAULT_SCENE)


def scene_from_document(document: Any, where: str = "scene") -> Tabletop:
    """Check a parsed `smash-scene/1` document and build the tabletop.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    check_format(document, where, SCENE_FORMAT)
    if document.get("base") == "default":
        if "name" not in document:
            raise MalformedFile(where, "missing `name`: a scene with a base has one of its own")
        document = {**scene_document(DEFAULT_SCENE), **document}
    file = cast(_SceneFile, convert(document, _SceneFile, where))
    if not file.stacks:
        raise MalformedFile(where, "`stacks`: at least one is needed")
    for number, stack in enumerate(file.stacks):
        if len(set(stack.topple)) < len(stack.topple):
            known = ", ".join(DIRECTIONS)
            raise MalformedFile(where, f"`stacks[{number}].topple`: any of {known}, each once")
    usual = _usual(file.block, where)
    table = Tabletop(
        name=file.name,
        side=usual.footprint,
        mass=usual.mass,
        friction=Friction(file.friction.block, file.friction.table, file.friction.finger),
        velocity=file.speed.velocity,
        acceleration=file.speed.acceleration,
        stacks=tuple(Slot(s.radius, radians(s.angle), tuple(s.topple), s.highest, s.falling) for s in file.stacks),
        buffers=tuple(Slot(b.radius, radians(b.angle), highest=b.highest) for b in file.buffers),
        noise=_noise(file.noise, where),
        engine=file.engine,
        height=None if usual.is_cube else usual.height,
        sizes=_sizes(file.blocks, usual, where),
    )
    if file.stations:
        tray, stations = Tray(table.longest, **msgspec.to_builtins(file.tray)), file.stations
        table = replace(table, tray=tray, stations=tuple(Slot(s.radius, radians(s.angle)) for s in stations))
    if file.robot is not None:
        table = _with_robot(table, file.robot, where)
    _refuse_overlap(table, where)
    return table


def _with_robot(table: Tabletop, robot: str, where: str) -> Tabletop:
    """The same table with the robot that its file names.

    Raises:
        MalformedFile: where there is none of that name, its own file is malformed, or it cannot hold the blocks.
    """
    try:
        return table.with_robot(beside(robot, where))
    except MalformedFile:
        raise
    except SmashError as error:
        raise MalformedFile(where, str(error)) from None


def _usual(file: _BlockFile, where: str) -> BlockSize:
    """The size of a block that has none of its own: a cube, where the file says no more than its side.

    Raises:
        MalformedFile: where it has an edge that is not allowed.
    """
    if file.footprint is None and file.height is None:
        return BlockSize(file.side, file.side, file.mass)
    footprint, height = (file.side if edge is None else edge for edge in (file.footprint, file.height))
    _require_allowed("block", footprint, height, where)
    return BlockSize(footprint, height, file.mass)


def _sizes(files: Mapping[str, _SizeFile], usual: BlockSize, where: str) -> dict[str, BlockSize]:
    """The blocks that have a size of their own: what one does not say is as usual, its density too.

    Raises:
        MalformedFile: where one of them has an edge or a mass that is not allowed.
    """
    sizes = {}
    for name, file in files.items():
        footprint = usual.footprint if file.footprint is None else file.footprint
        height = usual.height if file.height is None else file.height
        _require_allowed(f"blocks.{name}", footprint, height, where)
        share = footprint**2 * height / (usual.footprint**2 * usual.height)
        mass = usual.mass * share if file.mass is None else file.mass
        if not 0.0 < mass <= HEAVIEST:
            raise MalformedFile(where, f"`blocks.{name}.mass`: {mass:g} is not allowed; above 0, {HEAVIEST:g} at most")
        sizes[name] = BlockSize(footprint, height, mass)
    return sizes


def _require_allowed(block: str, footprint: float, height: float, where: str) -> None:
    """Refuse a block with edges that the format does not allow: no hand of the package could hold it.

    Raises:
        MalformedFile: with the block, and what is allowed.
    """
    for what, edge, (least, most) in (("footprint", footprint, FOOTPRINTS), ("height", height, HEIGHTS)):
        if not least <= edge <= most:
            allowed = f"{least:g} to {most:g}, whatever the hand"
            raise MalformedFile(where, f"`{block}.{what}`: {edge:g} m is not allowed; {allowed}")


def _noise(file: _NoiseFile, where: str) -> Noise:
    """The noise of a file, its yaw in degrees there.

    Raises:
        MalformedFile: where an amount is out of its limits.
    """
    amounts = {**msgspec.to_builtins(file), "yaw": radians(file.yaw)}
    try:
        return checked_noise(Noise(**amounts), "`noise`")
    except SmashError as error:
        raise MalformedFile(where, str(error)) from None


def beside(robot: str, scene: str) -> str:
    """Return the robot that a scene file names: files are looked for beside it."""
    return str(Path(scene).absolute().parent / robot) if robot.endswith(".toml") else robot


def scene_of(
    scene: str | os.PathLike[str] | Tabletop | None = None,
    noise: str | None = None,
    pace: float | None = None,
    robot: str | os.PathLike[str] | None = None,
) -> Tabletop:
    """Return a scene: the built-in one where none is given, with another noise, pace and robot where these are.

    Args:
        scene: a scene, or the path of its file.
        noise: as `parse_noise` reads it; it takes the place of all of the scene's own.
        pace: share of the arm's velocity and acceleration limits that motions use.
        robot: name of a robot, or the path of its file.

    Raises:
        SmashError: with one line, where one of them is not allowed.
    """
    if not isinstance(scene, Tabletop):
        scene = default_scene() if scene is None else read_scene(scene)
    if noise is not None:
        scene = replace(scene, noise=parse_noise(noise))
    if pace is not None:
        if not SLOWEST <= pace <= 1.0:
            raise SmashError(f"pace: {pace} is not allowed; {SLOWEST:g} to 1")
        scene = replace(scene, velocity=pace, acceleration=pace)
    if robot is not None:
        named = os.fspath(robot)
        scene = scene.with_robot(os.path.abspath(named) if named.endswith(".toml") else named)
    return scene


def _refuse_overlap(table: Tabletop, where: str) -> None:
    """Two piles that touch are no layout; whether they stand far enough apart is `conditions`' question."""
    groups = {"stacks": table.stacks, "buffers": table.buffers, "stations": table.stations}
    named = [(f"{group}[{index}]", slot) for group, slots in groups.items() for index, slot in enumerate(slots)]
    reach = 0.0 if table.tray is None else hypot(*table.tray.size) / 2
    for first, (other, there) in enumerate(named):
        for name, slot in named[first + 1 :]:
            trays = name.startswith("stations") + other.startswith("stations")
            least = trays * reach + LEAST_APART / 2 * table.widest * (2 - trays)
            apart = slot.distance(there.x, there.y)
            if apart < least:
                problem = f"stands {apart:.3f} m from {other}; {least:.3f} or more is allowed"
                raise MalformedFile(where, f"`{name}`: {problem}")
