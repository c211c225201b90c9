"""The tray, which is what a carrier is in a scene: a board with a low rim, cells for blocks, and a post to hold it by.

Its frame has its origin in the middle of the board, z upward, x along the two columns of cells. The post stands in the
middle, higher than the blocks beside it, so that the hand closes over their heads; the columns lie so far from the post
that the hand, its thin side along x, sets a block down beside it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import atan2

import numpy as np
from numpy.typing import NDArray

from smash.execution.scene.block_pose import BlockPose, standing
from smash.motion.obstacles import CarrierBody, Scene
from smash.motion.robot import Hand
from smash.motion.robots import load_robot

BESIDE_POST = 0.012
"""Room between the hand and the post while a block is set down beside it [m]."""
BESIDE_BLOCK = 0.013
"""Room between the open fingers around a block and the block of the next row [m]."""
PLAY = 0.003
"""Room between a block in its cell and the rim [m]."""
RIM_THICKNESS = 0.003
GRIP_DEPTH = 0.012
"""The tool's point is this far below the post's top when the hand holds it [m]."""
OVER_BLOCKS = 0.008
"""Room between the fingertips at the post and the tops of the blocks [m]."""


@dataclass(frozen=True)
class Tray:
    """A tray with cells for blocks up to one size.

    Attributes:
        side: Longest edge of a block [m].
        rows: Of cells, two in each.
        board: The board's thickness [m].
        rim: The rim's height above the board [m].
        post: The post's side [m].
        mass: [kg].
        friction: Coulomb coefficient; at a contact it multiplies with that of the other body.
        robot: Whose hand it is made for; no part of what tells scenes apart.
    """

    side: float
    rows: int = 1
    board: float = 0.010
    rim: float = 0.006
    post: float = 0.022
    mass: float = 0.25
    friction: float = 0.9
    robot: str | None = field(default=None, repr=False)

    @property
    def _hand(self) -> Hand:
        return load_robot(self.robot).hand

    @property
    def capacity(self) -> int:
        """Number of cells."""
        return 2 * self.rows

    @property
    def post_height(self) -> float:
        """Of the post above the board [m]."""
        return self.side + OVER_BLOCKS + self._hand.tip + GRIP_DEPTH

    @property
    def size(self) -> tuple[float, float]:
        """Length and width of the board [m]."""
        around = self.side / 2 + PLAY + RIM_THICKNESS
        return 2 * (self._column + around), 2 * ((self.rows - 1) / 2 * self._pitch + around)

    @property
    def _column(self) -> float:
        """Distance of a column of cells from the post's middle [m]."""
        return self._hand.palm_thickness + self.post / 2 + BESIDE_POST

    @property
    def _pitch(self) -> float:
        """Distance between the rows [m]."""
        return self.side + float(self._hand.finger[1, 1]) + BESIDE_BLOCK

    @cached_property
    def cells(self) -> NDArray[np.float64]:
        """Where blocks stand: their centres in the tray's frame [m], shape (capacity, 3)."""
        rows = (np.arange(self.rows) - (self.rows - 1) / 2) * self._pitch
        height = self.board / 2 + self.side / 2
        return np.array([[x, y, height] for y in rows for x in (self._column, -self._column)])

    @cached_property
    def boxes(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Centres and half extents of its boxes in its frame [m], both of shape (6, 3): board, post, rim."""
        length, width = self.size
        x, y, low = length / 2, width / 2, self.board / 2
        thin, rim, post = RIM_THICKNESS / 2, self.rim / 2, self.post_height / 2
        centres = [[0, 0, 0], [0, 0, low + post]]
        half = [[x, y, low], [self.post / 2, self.post / 2, post]]
        for sign in (1, -1):
            centres += [[sign * (x - thin), 0, low + rim], [0, sign * (y - thin), low + rim]]
            half += [[thin, y, rim], [x, thin, rim]]
        return np.array(centres, dtype=np.float64), np.array(half, dtype=np.float64)

    def scene(self, name: str, pose: BlockPose) -> Scene:
        """The boxes of the carrier called `name`, which stands at `pose`."""
        centres, half = self.boxes
        body: list[CarrierBody] = [CarrierBody(name)] * len(half)
        axes = np.tile(pose.rotation, (len(half), 1, 1))
        return Scene.of_boxes(body, pose.position + centres @ pose.rotation.T, half, axes)

    def at(self, x: float, y: float, yaw: float) -> BlockPose:
        """Its pose where it stands on the table, its x axis along `yaw` [rad]."""
        return standing(x, y, self.board / 2, yaw)

    def grip(self, pose: BlockPose) -> NDArray[np.float64]:
        """The point of the post that the hand takes, in the world [m], shape (3,)."""
        height = self.board / 2 + self.post_height - GRIP_DEPTH
        return np.asarray(pose.position + height * pose.rotation[:, 2])

    def _middles(self, height: float | None) -> NDArray[np.float64]:
        """Where the centres of blocks of this height are in the cells [m], shape (capacity, 3)."""
        if height is None:
            return self.cells
        return np.asarray(self.cells + np.array([0.0, 0.0, (height - self.side) / 2]))

    def cell(self, pose: BlockPose, index: int, height: float | None = None) -> BlockPose:
        """Where a block stands in a cell of the tray at `pose`; as high as `side`, where its height is not said [m]."""
        return BlockPose(pose.position + pose.rotation @ self._middles(height)[index], pose.rotation)

    def cell_of(self, pose: BlockPose, block: BlockPose, height: float | None = None) -> int | None:
        """The cell that a block stands in, upright on the board; None: it does not stand on this tray.

        Args:
            pose: Of the tray.
            block: Of the block.
            height: How high it stands [m]; as high as `side`, where it is not said.
        """
        inside = pose.rotation.T @ (block.position - pose.position)
        away = np.abs(self._middles(height) - inside)
        nearest = int(away.sum(axis=1).argmin())
        leans = float(np.arccos(np.clip(np.abs(pose.rotation[:, 2] @ block.rotation).max(), 0.0, 1.0)))
        near = bool((away[nearest] < (self.side / 3, self.side / 3, (height or self.side) / 5)).all())
        return nearest if near and leans < UPRIGHT else None

    def free_cells(
        self, pose: BlockPose, blocks: Mapping[str, BlockPose], heights: Mapping[str, float] | None = None
    ) -> list[int]:
        """The cells that no block stands in, in order; `heights` [m] are those of blocks that are not `side` high."""
        taken = {self.cell_of(pose, block, (heights or {}).get(name)) for name, block in blocks.items()}
        return [index for index in range(self.capacity) if index not in taken]


UPRIGHT = 0.1
"""A block on a tray leans no further than this [rad]."""


def heading(pose: BlockPose) -> float:
    """How a tray is turned about the vertical [rad]: the direction of its x axis (a block's `yaw` is of a quarter)."""
    return atan2(float(pose.rotation[1, 0]), float(pose.rotation[0, 0]))
