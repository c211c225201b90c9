"""Scene files, `smash-scene/1`: block size, friction, speed and layout, in TOML or JSON, checked strictly.

A file that says `base = "default"` has from the default scene what it does not hold itself.
"""

from __future__ import annotations

import os
from dataclasses import replace
from functools import cache
from math import hypot, radians
from pathlib import Path
from typing import Annotated, Any, Literal, cast

import msgspec

from smash.execution.scene.noise import checked_noise, parse_noise
from smash.execution.scene.tabletop import DIRECTIONS, SLOWEST, Friction, Noise, Slot, Tabletop
from smash.execution.scene.tray import Tray
from smash.problem.errors import MalformedFile, SmashError
from smash.problem.files.documents import check_format, convert, parse_json, parse_toml, read_bytes

SCENE_FORMAT = "smash-scene/1"
DEFAULT_SCENE = Path(__file__).parent / "default.toml"

_Share = Annotated[float, msgspec.Meta(ge=SLOWEST, le=1.0)]
_Coefficient = Annotated[float, msgspec.Meta(gt=0.0, le=2.0)]


class _BlockFile(msgspec.Struct, forbid_unknown_fields=True):
    side: Annotated[float, msgspec.Meta(ge=0.03, le=0.06)] = 0.045
    mass: Annotated[float, msgspec.Meta(gt=0.0, le=1.0)] = 0.1


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


class _BufferFile(msgspec.Struct, forbid_unknown_fields=True):
    radius: Annotated[float, msgspec.Meta(ge=0.25, le=0.75)]
    angle: Annotated[float, msgspec.Meta(ge=-180.0, le=180.0)]


class _StackFile(_BufferFile, forbid_unknown_fields=True):
    topple: list[Literal["counter-clockwise", "clockwise", "outward", "inward"]]


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
    friction: _FrictionFile = msgspec.field(default_factory=_FrictionFile)
    speed: _SpeedFile = msgspec.field(default_factory=_SpeedFile)
    buffers: list[_BufferFile] = []
    tray: _TrayFile = msgspec.field(default_factory=_TrayFile)
    stations: list[_BufferFile] = []
    noise: _NoiseFile = msgspec.field(default_factory=_NoiseFile)


def read_scene(path: str | os.PathLike[str]) -> Tabletop:
    """Read and check a scene file: TOML where its name ends in `.toml`, else JSON.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    where = os.fspath(path)
    return scene_from_document(_parse(read_bytes(path), where), where)


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
        document = {**_parse(read_bytes(DEFAULT_SCENE), str(DEFAULT_SCENE)), **document}
    file = cast(_SceneFile, convert(document, _SceneFile, where))
    if not file.stacks:
        raise MalformedFile(where, "`stacks`: at least one is needed")
    for number, stack in enumerate(file.stacks):
        if not stack.topple or len(set(stack.topple)) < len(stack.topple):
            known = ", ".join(DIRECTIONS)
            raise MalformedFile(where, f"`stacks[{number}].topple`: one or more of {known}, each once")
    table = Tabletop(
        name=file.name,
        side=file.block.side,
        mass=file.block.mass,
        friction=Friction(file.friction.block, file.friction.table, file.friction.finger),
        velocity=file.speed.velocity,
        acceleration=file.speed.acceleration,
        stacks=tuple(Slot(s.radius, radians(s.angle), tuple(s.topple)) for s in file.stacks),
        buffers=tuple(Slot(b.radius, radians(b.angle)) for b in file.buffers),
        noise=_noise(file.noise, where),
        engine=file.engine,
    )
    if file.stations:
        tray, stations = Tray(file.block.side, **msgspec.to_builtins(file.tray)), file.stations
        table = replace(table, tray=tray, stations=tuple(Slot(s.radius, radians(s.angle)) for s in stations))
    if file.robot is not None:
        table = table.with_robot(beside(file.robot, where))
    _refuse_overlap(table, where)
    return table


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


def _parse(content: bytes, where: str) -> Any:
    return parse_toml(content, where) if where.endswith(".toml") else parse_json(content, where)


def _refuse_overlap(table: Tabletop, where: str) -> None:
    """Two piles that touch are no layout; whether they stand far enough apart is `conditions`' question."""
    groups = {"stacks": table.stacks, "buffers": table.buffers, "stations": table.stations}
    named = [(f"{group}[{index}]", slot) for group, slots in groups.items() for index, slot in enumerate(slots)]
    reach = 0.0 if table.tray is None else hypot(*table.tray.size) / 2
    for first, (other, there) in enumerate(named):
        for name, slot in named[first + 1 :]:
            trays = name.startswith("stations") + other.startswith("stations")
            least = trays * reach + 0.75 * table.side * (2 - trays)
            apart = slot.distance(there.x, there.y)
            if apart < least:
                problem = f"stands {apart:.3f} m from {other}; {least:.3f} or more is allowed"
                raise MalformedFile(where, f"`{name}`: {problem}")
