"""The physics of one episode, whatever simulates it: one protocol, an engine a file.

A world is opened once per episode and never used again. Everything that moves in it goes through `follow`, `grip` and
`wait`; nothing is attached, nothing is set. How a step is made, what the motors are told and where things are is the
engine's; what time is, what is recorded and when blocks are at rest is the same for all of them and stands here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from types import TracebackType
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.noise import Made
from smash.execution.scene.tabletop import Tabletop
from smash.motion.obstacles import BodyName
from smash.motion.robots import load_robot
from smash.motion.timing import Trajectory

STEP = 1 / 480
"""Time between two set-points of the arm [s]; an engine may make several steps of it."""
CONTACTS_EVERY = 4
"""Steps from one look at what the arm touches to the next."""
STILL_LINEAR = 0.003
"""Blocks slower than this [m/s] and ..."""
STILL_ANGULAR = 0.05
"""... this [rad/s] are at rest."""

Frame = Callable[["World"], None]


class World(ABC):
    """Arm, hand, table and blocks in one engine; use as a context manager.

    Args:
        tabletop: The scene.
        blocks: Poses of the blocks at the start, by name.
        ready: The arm at the start [rad], shape (n,).
        carriers: Poses of the carriers.
        gui: Open a window.
        on_frame: Called with the world, `frame_interval` of simulated time apart.
        frame_interval: [s].

    Attributes:
        engine: What it is called at the command line and in records.
        robot: The scene's robot, which has n joints.
        time: Simulated time [s].
        opening: Where the fingers are sent, from the middle [m].
        recorded: What arm [rad], shape (n,), and fingers [m from the middle] were sent to, with the time [s] of each
            step.
        meant: What the arm may touch at present.
        on_step: Called after each step of the simulation, for measurements.

    Raises:
        Unsupported: where a window was asked for that cannot be opened.
    """

    engine: ClassVar[str]

    def __init__(
        self,
        tabletop: Tabletop,
        blocks: Mapping[str, BlockPose],
        ready: NDArray[np.float64],
        *,
        carriers: Mapping[str, BlockPose] | None = None,
        made: Mapping[str, Made] | None = None,
        gui: bool = False,
        on_frame: Frame | None = None,
        frame_interval: float = 1 / 25,
    ) -> None:
        self.tabletop = tabletop
        self._made = made or {}
        self.robot = load_robot(tabletop.robot)
        self.time = 0.0
        self.opening = self.robot.hand.opening
        self._on_frame = on_frame
        self._frame_interval = frame_interval
        self._next_frame = 0.0
        self._target = self._sent = np.array(ready, dtype=np.float64)
        self.recorded: list[tuple[float, NDArray[np.float64], float]] = []
        self.meant: frozenset[BodyName] = frozenset()
        self.on_step: Frame | None = None
        self._touched: dict[str, None] = {}
        self._steps = 0
        try:
            self._open(blocks, carriers or {}, gui)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _as_made(self, block: str) -> Made:
        """One block as it is."""
        made = self._made.get(block)
        return made or Made(self.tabletop.side, self.tabletop.mass, self.tabletop.friction.block)

    @abstractmethod
    def _open(self, blocks: Mapping[str, BlockPose], carriers: Mapping[str, BlockPose], gui: bool) -> None:
        """Build the scene, with the arm where it is sent to and the fingers at `opening`."""

    @abstractmethod
    def close(self) -> None:
        """Give back what the engine holds; also of a world that was not opened whole."""

    @abstractmethod
    def _advance(self) -> None:
        """Let `STEP` pass."""

    @abstractmethod
    def _send(self, position: NDArray[np.float64], velocity: NDArray[np.float64]) -> None:
        """Set where the arm's motors pull to [rad] and at which speed [rad/s], both of shape (n,)."""

    @abstractmethod
    def _send_fingers(self) -> None:
        """Let the fingers' motors pull towards `opening`, until they are told otherwise."""

    @abstractmethod
    def in_contact(self) -> Iterable[str]:
        """The blocks that arm or hand touch now; one may be named several times."""

    @abstractmethod
    def _speeds(self) -> Iterable[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """Linear [m/s] and angular velocity [rad/s] of each block and carrier, both of shape (3,)."""

    @abstractmethod
    def pose(self, block: str) -> BlockPose:
        """Pose of a block."""

    @abstractmethod
    def poses(self) -> dict[str, BlockPose]:
        """Poses of all blocks."""

    @abstractmethod
    def carriers(self) -> dict[str, BlockPose]:
        """Poses of all carriers."""

    @abstractmethod
    def joints(self) -> NDArray[np.float64]:
        """Measured arm joints [rad], shape (n,)."""

    @abstractmethod
    def fingers(self) -> NDArray[np.float64]:
        """Measured place of each finger, from the middle [m], shape (2,)."""

    @abstractmethod
    def torques(self) -> NDArray[np.float64]:
        """What the arm's motors turn with [Nm], shape (n,)."""

    @abstractmethod
    def links(self) -> NDArray[np.float64]:
        """Position [m] and quaternion (x, y, z, w) of links 1 to n, hand and fingers, shape (n + 3, 7)."""

    @abstractmethod
    def tool_position(self) -> NDArray[np.float64]:
        """Measured position of the tool frame [m], shape (3,)."""

    def _step(self) -> None:
        self._advance()
        self.time += STEP
        self.recorded.append((self.time, self._sent, self.opening))
        self._steps += 1
        if self._steps % CONTACTS_EVERY == 0:
            self._note_contacts()
        if self.on_step is not None:
            self.on_step(self)
        if self._on_frame is not None and self.time >= self._next_frame:
            self._next_frame += self._frame_interval
            self._on_frame(self)

    def _note_contacts(self) -> None:
        """Remember the blocks that arm or hand touch and are not meant to."""
        for block in self.in_contact():
            if block not in self.meant:
                self._touched[block] = None

    def _hold(self) -> None:
        """Keep the arm where it was last sent to."""
        self._send(self._target, np.zeros_like(self._target))

    def touched(self) -> list[str]:
        """The blocks that the arm has touched unmeant since this was last asked, in the order in which it did."""
        blocks = list(self._touched)
        self._touched.clear()
        return blocks

    def follow(self, trajectory: Trajectory, opening: float | None = None) -> None:
        """Let the arm follow a trajectory; the fingers go to `opening` [m from the middle] meanwhile, if given."""
        if opening is not None and opening != self.opening:
            self.opening = opening
            self._send_fingers()
        positions = trajectory.sample(STEP)
        velocities = np.diff(positions, axis=0, prepend=trajectory.positions[:1]) / STEP
        for position, velocity in zip(positions, velocities, strict=True):
            self._send(position, velocity)
            self._sent = position
            self._step()
        self._target = trajectory.positions[-1].copy()
        self._hold()

    def wait(self, seconds: float) -> None:
        """Let time pass."""
        for _ in range(max(1, round(seconds / STEP))):
            self._step()

    def grip(self, opening: float, seconds: float) -> None:
        """Move each finger towards `opening` [m] from the middle, for `seconds`."""
        self.opening = opening
        self._send_fingers()
        self.wait(seconds)

    def settle(self, longest: float = 3.0, interval: float = 0.05) -> bool:
        """Let time pass until all blocks are at rest, `longest` seconds at most; say whether they are."""
        calm = 0
        for _ in range(round(longest / interval)):
            self.wait(interval)
            calm = calm + 1 if self.still() else 0
            if calm >= 2:
                return True
        return False

    def still(self) -> bool:
        """Whether every block and tray is at rest."""
        return all(
            np.linalg.norm(linear) <= STILL_LINEAR and np.linalg.norm(angular) <= STILL_ANGULAR
            for linear, angular in self._speeds()
        )

    def commanded(self) -> NDArray[np.float64]:
        """The joint positions that the arm was last sent to [rad], shape (n,)."""
        return self._target.copy()
