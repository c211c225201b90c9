"""The physics of one episode: PyBullet with the Panda and the blocks.

A world is opened once per episode and never used again: only a fresh connection with `deterministicOverlappingPairs`
repeats an episode bit for bit. Everything that moves in it goes through `follow`, `grip` and `wait`.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Callable, Mapping
from functools import partial
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from smash.execution.physics.simulated_robot import simulated_panda
from smash.execution.physics.window import furnish, require_display, words_to_stderr
from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.noise import Made
from smash.execution.scene.tabletop import Tabletop
from smash.motion.obstacles import BodyName
from smash.motion.timing import Trajectory

STEP = 1 / 480
"""Physics time step [s]: at 1/240 tall stacks drift by millimetres."""
ITERATIONS = 50
BASE = -1
ARM = tuple(range(7))
FINGERS = (9, 10)
TOOL_LINK = 11
ARM_FORCE = (87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0)
FINGER_FORCE = 40.0
FINGER_SPEED = 0.2
CONTACTS_EVERY = 4
"""Steps from one look at what the arm touches to the next."""
ASLEEP = 1e-5
"""A block whose squared speed [m2/s2 + rad2/s2] stays below this for two seconds is left out of the simulation until
something awake touches it or what it stands with: piles do not creep, and most of the work is spared."""
STILL_LINEAR = 0.003
"""Blocks slower than this [m/s] and ..."""
STILL_ANGULAR = 0.05
"""... this [rad/s] are at rest."""

Frame = Callable[["World"], None]


class World:
    """Panda, table and blocks in one PyBullet connection; use as a context manager."""

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
        self.time = 0.0
        self.opening = 0.04
        self._gui = gui
        self._on_frame = on_frame
        self._frame_interval = frame_interval
        self._next_frame = 0.0
        self._target = self._sent = np.array(ready, dtype=np.float64)
        self.recorded: list[tuple[float, NDArray[np.float64], float]] = []
        """What arm [rad], shape (7,), and fingers [m from the middle] were sent to, with the time [s] of each step."""
        self.meant: frozenset[BodyName] = frozenset()
        """What the arm may touch at present."""
        self.on_step: Frame | None = None
        """Called after each step of the simulation, for measurements."""
        self._touched: dict[str, None] = {}
        self._steps = 0
        self._after_close: Callable[[], None] | None = None
        if gui:
            require_display()
        self.client: Any = connect(gui)
        try:
            if gui:
                self._after_close = words_to_stderr()
                furnish(self.client, tabletop)
            self._set_up(blocks)
            self.trays = {name: self._add_tray(pose) for name, pose in (carriers or {}).items()}
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the connection."""
        if self.client is not None:
            self.client.disconnect()
            self.client = None
        if self._after_close is not None:
            self._after_close()
            self._after_close = None

    def _set_up(self, blocks: Mapping[str, BlockPose]) -> None:
        c, friction, side = self.client, self.tabletop.friction, self.tabletop.side
        c.setPhysicsEngineParameter(fixedTimeStep=STEP, numSolverIterations=ITERATIONS, deterministicOverlappingPairs=1)
        c.setGravity(0, 0, -9.81)
        shape = c.createCollisionShape(c.GEOM_BOX, halfExtents=[1.5, 1.5, 0.05])
        self.table: int = c.createMultiBody(0, shape, -1, [0, 0, -0.05])
        c.changeDynamics(self.table, -1, lateralFriction=friction.table)
        c.changeVisualShape(self.table, -1, rgbaColor=[0.93, 0.91, 0.87, 1])
        unseen = 0 if self._gui else c.URDF_IGNORE_VISUAL_SHAPES
        with simulated_panda() as urdf:
            self.robot: int = c.loadURDF(str(urdf), useFixedBase=True, flags=unseen)
        for finger in FINGERS:
            c.changeDynamics(self.robot, finger, lateralFriction=friction.finger)
        for joint in ARM:
            c.resetJointState(self.robot, joint, float(self._target[joint]))
        for finger in FINGERS:
            c.resetJointState(self.robot, finger, self.opening)
        self._couple_fingers()
        # The base is bolted to the table; its contacts would cost more than all blocks'.
        for link in (BASE, 0):
            c.setCollisionFilterPair(self.robot, self.table, link, -1, 0)
        alike = Made(side, self.tabletop.mass, friction.block)
        box = c.createCollisionShape(c.GEOM_BOX, halfExtents=[side / 2] * 3)
        self.bodies: dict[str, int] = {}
        for name, pose in blocks.items():
            made, shape = self._made.get(name, alike), box
            if made.side != side:
                shape = c.createCollisionShape(c.GEOM_BOX, halfExtents=[made.side / 2] * 3)
            body = c.createMultiBody(made.mass, shape, -1, pose.position.tolist(), quaternion_of(pose.rotation))
            c.changeDynamics(
                body,
                -1,
                lateralFriction=made.friction,
                activationState=c.ACTIVATION_STATE_ENABLE_SLEEPING,
                sleepThreshold=ASLEEP,
            )
            self.bodies[name] = body
        self._named = {body: name for name, body in self.bodies.items()}
        self._step_simulation = c.stepSimulation
        self._send_arm = partial(c.setJointMotorControlArray, self.robot, ARM, c.POSITION_CONTROL, forces=ARM_FORCE)
        self._hold()
        self._send_fingers()

    def _add_tray(self, pose: BlockPose) -> int:
        """One body of several boxes; its frame, the middle of the board, is its centre of mass."""
        c, tray = self.client, self.tabletop.tray
        assert tray is not None
        centres, half = (array.tolist() for array in tray.boxes)
        shape = c.createCollisionShapeArray(
            shapeTypes=[c.GEOM_BOX] * len(half), halfExtents=half, collisionFramePositions=centres
        )
        body: int = c.createMultiBody(tray.mass, shape, -1, pose.position.tolist(), quaternion_of(pose.rotation))
        c.changeDynamics(body, -1, lateralFriction=tray.friction)
        return body

    def _couple_fingers(self) -> None:
        """Let the fingers move as one: apart, they drift sideways together with the block that they squeeze."""
        c = self.client
        gear = c.createConstraint(
            self.robot, FINGERS[0], self.robot, FINGERS[1], c.JOINT_GEAR, [1, 0, 0], [0, 0, 0], [0, 0, 0]
        )
        c.changeConstraint(gear, gearRatio=-1, erp=0.2, maxForce=200)

    def _hold(self) -> None:
        """Keep the arm where it was last sent to."""
        self._send_arm(targetPositions=self._target.tolist(), targetVelocities=[0.0] * len(ARM))

    def _send_fingers(self) -> None:
        """Let the fingers' motors pull towards `opening`, until they are told otherwise."""
        for finger in FINGERS:
            self.client.setJointMotorControl2(
                self.robot,
                finger,
                self.client.POSITION_CONTROL,
                targetPosition=self.opening,
                force=FINGER_FORCE,
                maxVelocity=FINGER_SPEED,
            )

    def _step(self) -> None:
        self._step_simulation()
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
        for point in self.client.getContactPoints(bodyA=self.robot):
            block = self._named.get(point[2])
            if block is not None and block not in self.meant and point[8] <= 0.0:
                self._touched[block] = None

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
        for row, position, velocity in zip(positions, positions.tolist(), velocities.tolist(), strict=True):
            self._send_arm(targetPositions=position, targetVelocities=velocity)
            self._sent = row
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
        for body in (*self.bodies.values(), *self.trays.values()):
            linear, angular = self.client.getBaseVelocity(body)
            if np.linalg.norm(linear) > STILL_LINEAR or np.linalg.norm(angular) > STILL_ANGULAR:
                return False
        return True

    def pose(self, block: str) -> BlockPose:
        """Pose of a block."""
        return self._pose_of(self.bodies[block])

    def poses(self) -> dict[str, BlockPose]:
        """Poses of all blocks."""
        return {name: self._pose_of(body) for name, body in self.bodies.items()}

    def carriers(self) -> dict[str, BlockPose]:
        """Poses of all carriers."""
        return {name: self._pose_of(body) for name, body in self.trays.items()}

    def _pose_of(self, body: int) -> BlockPose:
        position, quaternion = self.client.getBasePositionAndOrientation(body)
        rotation = np.array(self.client.getMatrixFromQuaternion(quaternion)).reshape(3, 3)
        return BlockPose(np.array(position), rotation)

    def joints(self) -> NDArray[np.float64]:
        """Measured arm joints [rad], shape (7,)."""
        return np.array([state[0] for state in self.client.getJointStates(self.robot, ARM)])

    def commanded(self) -> NDArray[np.float64]:
        """The joint positions that the arm was last sent to [rad], shape (7,)."""
        return self._target.copy()

    def finger_opening(self) -> float:
        """Measured distance of a finger from the middle [m], the mean of both."""
        return float(np.mean([state[0] for state in self.client.getJointStates(self.robot, FINGERS)]))

    def tool_position(self) -> NDArray[np.float64]:
        """Measured position of the tool frame [m], shape (3,)."""
        return np.array(self.client.getLinkState(self.robot, TOOL_LINK, computeForwardKinematics=True)[4])


def connect(gui: bool) -> Any:
    """A new PyBullet connection, without the library's greetings on the user's output."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(1), os.dup(2)]
    silence = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(silence, 1)
        os.dup2(silence, 2)
        import pybullet
        from pybullet_utils.bullet_client import BulletClient

        return BulletClient(connection_mode=pybullet.GUI if gui else pybullet.DIRECT)
    finally:
        ctypes.CDLL(None).fflush(None)
        for number, copy in enumerate(kept, start=1):
            os.dup2(copy, number)
            os.close(copy)
        os.close(silence)


def quaternion_of(rotation: NDArray[np.float64]) -> list[float]:
    """Quaternion x, y, z, w of a rotation about the vertical followed by nothing else, or of any rotation matrix."""
    from scipy.spatial.transform import Rotation

    return [float(value) for value in Rotation.from_matrix(rotation).as_quat()]
