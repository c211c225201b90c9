"""Pictures of a recorded episode, drawn by PyBullet's software renderer in a connection of their own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from smash.execution.physics.pybullet_world import ARM, FINGERS, connect
from smash.execution.scene.tabletop import Tabletop
from smash.execution.viewing.recording import Recording
from smash.motion.robot import panda_urdf
from smash.problem.pictures import PALETTE

SIZE = (960, 640)
"""Width and height of a picture [pixels]."""
TRAY_COLOUR = (0.62, 0.47, 0.30)

Image = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Camera:
    """Where a picture is taken from.

    Attributes:
        yaw: About the vertical, 0 along the world's y axis [degrees].
        pitch: Downwards where it is negative [degrees].
        distance: From what is looked at [m].
    """

    yaw: float = 28.0
    pitch: float = -40.0
    distance: float = 1.45


CAMERA = Camera()
LOOKED_AT = (0.0, -0.02, 0.20)
"""[m]"""


def block_colours(count: int) -> list[tuple[float, float, float]]:
    """Red, green, blue in 0..1 for each block, in order: the colours that it has in every other picture."""
    paints = [PALETTE[number % len(PALETTE)] for number in range(count)]
    return [(int(p[1:3], 16) / 255, int(p[3:5], 16) / 255, int(p[5:7], 16) / 255) for p in paints]


class Stage:
    """Robot, table, slots and blocks to be posed and photographed; use as a context manager.

    Args:
        tabletop: The scene.
        blocks: How many there are.
        carriers: Likewise.
        coarse: Draw the robot's collision meshes, a thirtieth of the triangles, without shadows: for films.
    """

    def __init__(self, tabletop: Tabletop, blocks: int, carriers: int = 0, *, coarse: bool = False) -> None:
        self.client: Any = connect(gui=False)
        self._coarse = coarse
        c = self.client
        self.robot: int = self._panda()
        self._box([0.85, 0.85, 0.01], [0, 0, -0.01], (0.90, 0.88, 0.84))
        half = tabletop.side / 2
        for slot in tabletop.slots:
            colour = (0.62, 0.70, 0.82) if slot.directions else (0.78, 0.78, 0.76)
            turn = c.getQuaternionFromEuler([0, 0, slot.angle])
            self._box([half * 1.15, half * 1.15, 0.0005], [slot.x, slot.y, 0.0005], colour, turn)
        self.blocks = [self._box([half] * 3, [0, 0, 0], colour) for colour in block_colours(blocks)]
        self.trays = [self._tray(tabletop) for _ in range(carriers)]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.client.disconnect()

    def _panda(self) -> int:
        file = panda_urdf()
        if not self._coarse:
            return int(self.client.loadURDF(str(file), useFixedBase=True))
        text = file.read_text(encoding="utf-8").replace("package://", f"{file.parent}/")
        with TemporaryDirectory(prefix="smash-") as folder:
            copy = Path(folder) / file.name
            copy.write_text(text.replace("meshes/visual/", "meshes/collision/"), encoding="utf-8")
            return int(self.client.loadURDF(str(copy), useFixedBase=True))

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
        for joint, value in zip((*ARM, *FINGERS), recording.joints[frame], strict=True):
            self.client.resetJointState(self.robot, joint, float(value))
        moved = np.concatenate([recording.blocks[frame], recording.trays[frame]])
        for body, row in zip((*self.blocks, *self.trays), moved, strict=True):
            self.client.resetBasePositionAndOrientation(body, row[:3].tolist(), row[3:].tolist())

    def photograph(self, size: tuple[int, int], camera: Camera = CAMERA) -> Image:
        """A picture of the table, shape (height, width, 3)."""
        c, (width, height) = self.client, size
        view = c.computeViewMatrixFromYawPitchRoll(LOOKED_AT, camera.distance, camera.yaw, camera.pitch, 0.0, 2)
        lens = c.computeProjectionMatrixFOV(52.0, width / height, 0.1, 5.0)
        pixels = c.getCameraImage(
            width,
            height,
            view,
            lens,
            shadow=0 if self._coarse else 1,
            lightDirection=[0.6, 0.4, 1.4],
            renderer=c.ER_TINY_RENDERER,
        )[2]
        return np.asarray(pixels, dtype=np.uint8).reshape(height, width, 4)[:, :, :3]


def write_stills(path: Path, recording: Recording, tabletop: Tabletop, moments: Sequence[tuple[str, float]]) -> None:
    """Draw several moments of an episode side by side, each with its caption.

    Args:
        path: A picture file.
        recording: The episode.
        tabletop: Its scene.
        moments: Caption and simulated time [s] of each picture.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.8 * len(moments), 3.5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, len(moments), squeeze=False)[0]
    with Stage(tabletop, len(recording.blocks[0]), len(recording.trays[0])) as stage:
        for axis, (caption, moment) in zip(axes, moments, strict=True):
            stage.pose(recording, recording.at(moment))
            axis.imshow(stage.photograph(SIZE))
            axis.set_title(caption)
            axis.set_axis_off()
    figure.savefig(path, dpi=150)
