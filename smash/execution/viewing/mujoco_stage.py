"""The stage of MuJoCo's renderer, which draws by OpenGL without a window: EGL, or OSMesa where `MUJOCO_GL` says so."""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import mujoco
import numpy as np

from smash.execution.physics import mujoco_model as models
from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.marks import slot_marks
from smash.execution.scene.noise import as_told
from smash.execution.scene.tabletop import Tabletop
from smash.execution.viewing.recording import Recording
from smash.execution.viewing.stage import (
    CAMERA,
    LIGHT,
    LOOKED_AT,
    TABLE_COLOUR,
    TABLE_HALF,
    TRAY_COLOUR,
    VIEW_ANGLE,
    Camera,
    Image,
    Stage,
    block_colours,
)
from smash.motion.robots import load_robot
from smash.problem.errors import Unsupported
from smash.problem.words import one_line

CONTEXTS = ("egl", "osmesa")
"""Ways to OpenGL without a window, as `MUJOCO_GL` names them; the first one is taken where it names none."""
ROBOT_COLOUR = (0.93, 0.93, 0.93)
BACKGROUND = (1.0, 1.0, 1.0)
MOST_SHAPES = 2000
ELSEWHERE = BlockPose(np.zeros(3), np.eye(3))


def open_context(size: tuple[int, int]) -> Any:
    """Return an OpenGL context that needs no window, made current.

    Raises:
        Unsupported: where there is none.
    """
    chosen = os.environ.get("MUJOCO_GL", "").lower()
    name = chosen if chosen in CONTEXTS else CONTEXTS[0]
    try:
        context = import_module(f"mujoco.{name}").GLContext(*size)
        context.make_current()
    except Exception as error:  # the libraries of OpenGL fail in ways of their own
        words = f"MuJoCo draws by OpenGL, and {name} cannot be had here ({one_line(str(error))})"
        raise Unsupported(f"{words}: install Mesa's EGL, or OSMesa and say MUJOCO_GL=osmesa") from error
    return context


class MujocoStage(Stage):
    """The model of an episode's start with lights, its bodies put where they were."""

    _context: Any = None
    _painter: Any = None

    def _open(self, tabletop: Tabletop, blocks: Sequence[str], carriers: int) -> None:
        self._names = [models.block_body(block) for block in blocks]
        self._names += [models.carrier_body(str(number)) for number in range(carriers)]
        self.model = model = self._model(tabletop, blocks, carriers)
        self.data: Any = mujoco.MjData(model)
        robot = load_robot(tabletop.robot)
        joints = (*robot.joints, *robot.hand.joints)
        self._joints = np.array([model.joint(name).qposadr[0] for name in joints])
        self._bodies = [int(model.jnt_qposadr[model.body(name).jntadr[0]]) for name in self._names]
        self._context = open_context((64, 64))
        self._painter = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._painter)
        self._scene: Any = mujoco.MjvScene(model, MOST_SHAPES)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = not self._coarse
        self._scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False

    def close(self) -> None:
        """Give back the context."""
        for held in (self._painter, self._context):
            if held is not None:
                held.free()

    def _model(self, tabletop: Tabletop, blocks: Sequence[str], carriers: int) -> Any:
        made = {block: as_told(tabletop, block) for block in blocks}
        trays = [str(number) for number in range(carriers)]
        spec = models.specification(tabletop, dict.fromkeys(blocks, ELSEWHERE), dict.fromkeys(trays, ELSEWHERE), made)
        # What does not collide is not in the simulated model, and neither are textures: here it is what is looked at.
        spec.compiler.discardvisual = False
        colours = dict(zip(self._names, block_colours(len(blocks)), strict=False))
        for shape in spec.geoms:
            colour = colours.get(shape.name, TRAY_COLOUR if shape.name.startswith("carrier") else ROBOT_COLOUR)
            if shape.name == "table":
                shape.size, shape.pos, colour = TABLE_HALF, [0.0, 0.0, -TABLE_HALF[2]], TABLE_COLOUR
            shape.rgba = [*colour, 1.0]
        for slot, half, colour in slot_marks(tabletop):
            turn, place = [np.cos(slot.angle / 2), 0.0, 0.0, np.sin(slot.angle / 2)], [slot.x, slot.y, half[2]]
            spec.worldbody.add_geom(
                type=mujoco.mjtGeom.mjGEOM_BOX,
                size=half,
                pos=place,
                quat=turn,
                rgba=[*colour, 1.0],
                contype=0,
                conaffinity=0,
            )
        _light(spec, shadows=not self._coarse)
        return spec.compile()

    def pose(self, recording: Recording, frame: int) -> None:
        """Move everything to where it was in a frame."""
        place = self.data.qpos
        place[self._joints] = recording.joints[frame]
        moved = np.concatenate([recording.blocks[frame], recording.trays[frame]])
        for first, (x, y, z, i, j, k, real) in zip(self._bodies, moved, strict=True):
            place[first : first + 7] = x, y, z, real, i, j, k
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)

    def photograph(self, size: tuple[int, int], camera: Camera = CAMERA) -> Image:
        """A picture of the table of this width and height [pixels], shape (height, width, 3)."""
        width, height = size
        if (self._painter.offWidth, self._painter.offHeight) != size:
            mujoco.mjr_resizeOffscreen(width, height, self._painter)
        view = mujoco.MjvCamera()
        view.lookat[:], view.distance = LOOKED_AT, camera.distance
        view.azimuth, view.elevation = camera.yaw + 90.0, camera.pitch
        mujoco.mjv_updateScene(
            self.model, self.data, mujoco.MjvOption(), None, view, mujoco.mjtCatBit.mjCAT_ALL, self._scene
        )
        place, image = mujoco.MjrRect(0, 0, width, height), np.empty((height, width, 3), dtype=np.uint8)
        mujoco.mjr_render(place, self._scene, self._painter)
        mujoco.mjr_readPixels(image, None, place, self._painter)
        return image[::-1]


def _light(spec: Any, *, shadows: bool) -> None:
    """Give a model a light, a background and the lens of our cameras."""
    spec.stat.extent = 2.0
    spec.visual.global_.fovy = VIEW_ANGLE
    spec.visual.quality.offsamples = 4
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.45] * 3, [0.25] * 3
    spec.visual.headlight.specular = [0.0] * 3
    lamp = spec.worldbody.add_light(pos=LIGHT, dir=[-part for part in LIGHT], castshadow=shadows)
    lamp.type, lamp.diffuse, lamp.specular = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, [0.45] * 3, [0.1] * 3
    sky = spec.add_texture(name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, width=16, height=96)
    sky.builtin, sky.rgb1, sky.rgb2 = mujoco.mjtBuiltin.mjBUILTIN_FLAT, BACKGROUND, BACKGROUND
