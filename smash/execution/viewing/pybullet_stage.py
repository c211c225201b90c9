"""The stage of PyBullet's software renderer, in a connection of its own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smash.execution.physics.pybullet_world import connect, numbers_of
from smash.execution.physics.simulated_robot import urdf_file
from smash.execution.scene.marks import slot_marks
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


class PyBulletStage(Stage):
    """Bodies of PyBullet without mass.

    For films table and slots stand in a connection of their own: they fill most of a picture and never move, so they
    are painted once, and each frame's robot, blocks and trays are laid over them.
    """

    client: Any
    _backdrop: tuple[tuple[int, int], Camera, Image] | None = None

    def _open(self, tabletop: Tabletop, blocks: Sequence[str], carriers: int) -> None:
        self.client = c = connect(gui=False)
        robot = load_robot(tabletop.robot)
        with urdf_file(robot.urdf) as urdf:
            self.robot = int(c.loadURDF(str(urdf), useFixedBase=True))
        self._joints = [number for numbers in numbers_of(c, self.robot, robot) for number in numbers]
        self._furniture = connect(gui=False) if self._coarse else c
        self._furnish(tabletop)
        looks = zip(blocks, block_colours(len(blocks)), strict=True)
        self.blocks = [_box(c, tabletop.size(block).half.tolist(), [0, 0, 0], colour) for block, colour in looks]
        self.trays = [self._tray(tabletop) for _ in range(carriers)]

    def close(self) -> None:
        """End the connections."""
        self.client.disconnect()
        if self._coarse:
            self._furniture.disconnect()

    def _furnish(self, tabletop: Tabletop) -> None:
        c = self._furniture
        _box(c, TABLE_HALF, [0, 0, -TABLE_HALF[2]], TABLE_COLOUR)
        for slot, half, colour in slot_marks(tabletop):
            _box(c, half, [slot.x, slot.y, half[2]], colour, c.getQuaternionFromEuler([0, 0, slot.angle]))

    def _tray(self, tabletop: Tabletop) -> int:
        c = self.client
        assert tabletop.tray is not None
        centres, half = (array.tolist() for array in tabletop.tray.boxes)
        shape = c.createVisualShapeArray(
            shapeTypes=[c.GEOM_BOX] * len(half),
            halfExtents=half,
            visualFramePositions=centres,
            rgbaColors=[[*TRAY_COLOUR, 1]] * len(half),
        )
        return int(c.createMultiBody(0, -1, shape, [0, 0, 0]))

    def pose(self, recording: Recording, frame: int) -> None:
        """Move everything to where it was in a frame."""
        for joint, value in zip(self._joints, recording.joints[frame], strict=True):
            self.client.resetJointState(self.robot, joint, float(value))
        moved = np.concatenate([recording.blocks[frame], recording.trays[frame]])
        for body, row in zip((*self.blocks, *self.trays), moved, strict=True):
            self.client.resetBasePositionAndOrientation(body, row[:3].tolist(), row[3:].tolist())

    def photograph(self, size: tuple[int, int], camera: Camera = CAMERA) -> Image:
        """A picture of the table of this width and height [pixels], shape (height, width, 3)."""
        picture, seen = self._shoot(self.client, size, camera)
        if not self._coarse:
            return picture
        if self._backdrop is None or self._backdrop[:2] != (size, camera):
            self._backdrop = (size, camera, self._shoot(self._furniture, size, camera)[0])
        return np.where(seen[:, :, None], picture, self._backdrop[2])

    def _shoot(self, client: Any, size: tuple[int, int], camera: Camera) -> tuple[Image, NDArray[np.bool_]]:
        """What is in a connection, shape (height, width, 3), and where something is, shape (height, width)."""
        width, height = size
        view = client.computeViewMatrixFromYawPitchRoll(LOOKED_AT, camera.distance, camera.yaw, camera.pitch, 0.0, 2)
        lens = client.computeProjectionMatrixFOV(VIEW_ANGLE, width / height, 0.1, 5.0)
        _, _, pixels, _, bodies = client.getCameraImage(
            width,
            height,
            view,
            lens,
            shadow=0 if self._coarse else 1,
            lightDirection=LIGHT,
            renderer=client.ER_TINY_RENDERER,
        )
        picture = np.asarray(pixels, dtype=np.uint8).reshape(height, width, 4)[:, :, :3]
        return picture, np.asarray(bodies).reshape(height, width) >= 0


def _box(
    client: Any,
    half: Sequence[float],
    position: Sequence[float],
    colour: Sequence[float],
    turn: Sequence[float] = (0, 0, 0, 1),
) -> int:
    shape = client.createVisualShape(client.GEOM_BOX, halfExtents=half, rgbaColor=[*colour, 1])
    return int(client.createMultiBody(0, -1, shape, position, turn))
