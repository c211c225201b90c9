"""The stage of PyBullet's software renderer, in a connection of its own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from smash.execution.physics.pybullet_world import connect, numbers_of
from smash.execution.physics.simulated_robot import urdf_file
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
    slot_look,
)
from smash.motion.robots import load_robot


class PyBulletStage(Stage):
    """Bodies of PyBullet without mass."""

    client: Any

    def _open(self, tabletop: Tabletop, blocks: int, carriers: int) -> None:
        self.client = c = connect(gui=False)
        robot = load_robot(tabletop.robot)
        with urdf_file(robot.urdf) as urdf:
            self.robot = int(c.loadURDF(str(urdf), useFixedBase=True))
        self._joints = [number for numbers in numbers_of(c, self.robot, robot) for number in numbers]
        self._box(TABLE_HALF, [0, 0, -TABLE_HALF[2]], TABLE_COLOUR)
        for slot in tabletop.slots:
            half, colour = slot_look(slot, tabletop.side)
            self._box(half, [slot.x, slot.y, half[2]], colour, c.getQuaternionFromEuler([0, 0, slot.angle]))
        self.blocks = [self._box([tabletop.side / 2] * 3, [0, 0, 0], colour) for colour in block_colours(blocks)]
        self.trays = [self._tray(tabletop) for _ in range(carriers)]

    def close(self) -> None:
        """End the connection."""
        self.client.disconnect()

    def _box(
        self,
        half: Sequence[float],
        position: Sequence[float],
        colour: Sequence[float],
        turn: Sequence[float] = (0, 0, 0, 1),
    ) -> int:
        c = self.client
        shape = c.createVisualShape(c.GEOM_BOX, halfExtents=half, rgbaColor=[*colour, 1])
        return int(c.createMultiBody(0, -1, shape, position, turn))

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
        c, (width, height) = self.client, size
        view = c.computeViewMatrixFromYawPitchRoll(LOOKED_AT, camera.distance, camera.yaw, camera.pitch, 0.0, 2)
        lens = c.computeProjectionMatrixFOV(VIEW_ANGLE, width / height, 0.1, 5.0)
        pixels = c.getCameraImage(
            width,
            height,
            view,
            lens,
            shadow=0 if self._coarse else 1,
            lightDirection=LIGHT,
            renderer=c.ER_TINY_RENDERER,
        )[2]
        return np.asarray(pixels, dtype=np.uint8).reshape(height, width, 4)[:, :, :3]
